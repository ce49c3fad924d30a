#pragma once
// The object rendered alone in the views of the scene, compared with its mask in the scene.
#include <vector>

#include "ngs/edit/finish/support_view.h"

namespace ngs::finish {

struct AloneViews {
  const std::vector<SupportView>& views;
  const SplatOptions& splat;  // of the scene, not prepared for a model
  double behind;              // as in SupportView::sides()
};

struct AloneObject {
  const GaussianCloud& cloud;
  const std::vector<std::uint8_t>& seen;  // [object] 1: a view sees the Gaussian's centre
};

/// What the rendering of a part of the object alone shows.
struct Alone {
  std::vector<std::uint8_t> keep;                    // [object] 0: left out
  WrongPixels wrong = {};                            // of all views
  std::vector<std::vector<std::uint8_t>> seen = {};  // [views] SupportView::seen_alone()
};

Alone rendered_alone(const Exec& exec, const AloneViews& in, const GaussianCloud& object,
                     std::vector<std::uint8_t> keep);

/// Whether clipping at a plane cuts off what the scene shows. The number of wrong pixels does not tell: where another
/// thing hides the end of the object, a wrong plane leaves fewer of them, too.
bool plane_cuts_off(const WrongPixels& with, const WrongPixels& without);

/// [object] 1: shows the object, rendered alone, where the scene does not: outside of its rendered mask and the soft
/// edge of it, with more of its weight than within. Where other things stand in front of the object alone, only if no
/// view sees the Gaussian's centre, and with more than 10 times that. 0 for Gaussians that were left out.
std::vector<std::uint8_t> contradicted(const Exec& exec, const AloneViews& in, const AloneObject& object,
                                       const Alone& alone);

/// Leaves the contradicted Gaussians out, and those that are contradicted then, unless more pixels are wrong without
/// them.
void drop_contradicted(const Exec& exec, const AloneViews& in, const AloneObject& object, Alone& alone);

}  // namespace ngs::finish
