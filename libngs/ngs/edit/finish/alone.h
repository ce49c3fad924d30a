#pragma once
// The object rendered alone in the views of the scene, compared with its mask in the scene.
#include <vector>

#include "ngs/edit/finish/support_view.h"

namespace ngs::finish {

struct AloneViews {
  const std::vector<SupportView>& views;
  const SplatOptions& splat;  // of the scene, not prepared for a model
  double behind;              // as in SupportView::statuses()
};

struct AloneObject {
  const GaussianCloud& cloud;
  const std::vector<std::uint8_t>& seen;  // [object] 1: a view sees the Gaussian's centre
};

/// Result of rendering a part of the object without the rest of the scene.
struct Alone {
  std::vector<std::uint8_t> keep;                    // [object] 0: left out
  WrongPixels wrong = {};                            // of all views
  std::vector<std::vector<std::uint8_t>> seen = {};  // [views] SupportView::seen_alone()
};

Alone rendered_alone(const Exec& exec, const AloneViews& in, const GaussianCloud& object,
                     std::vector<std::uint8_t> keep);

/// Whether clipping at a plane removes a visible part of the object. The number of wrong pixels cannot decide this: if
/// another thing occludes the object's end, a wrong plane lowers the number too.
bool plane_cuts_off(const WrongPixels& with, const WrongPixels& without);

/// [object] 1: the views contradict the Gaussian. With the object rendered alone, more of its weight lies outside the
/// masks than inside. If no view sees its centre, more than 10 times the weight inside also suffices, and weight that
/// the scene occludes then counts as outside. 0 for Gaussians that were left out before.
std::vector<std::uint8_t> contradicted(const Exec& exec, const AloneViews& in, const AloneObject& object,
                                       const Alone& alone);

/// Removes contradicted Gaussians in up to two rounds. A round that increases the number of wrong pixels is undone.
void drop_contradicted(const Exec& exec, const AloneViews& in, const AloneObject& object, Alone& alone);

}  // namespace ngs::finish
