#pragma once
// The object rendered alone in the views of the scene, compared with its mask in the scene.
#include <array>
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
  std::vector<std::uint8_t> keep;  // [object] 0: left out
  /// Pixels of all views where alpha of the object alone is at least 1/2, but the scene does not show it, or the
  /// reverse.
  std::int64_t wrong = 0;
  std::vector<std::vector<std::uint8_t>> seen = {};  // [views] SupportView::seen_alone()
};

Alone rendered_alone(const Exec& exec, const AloneViews& in, const GaussianCloud& object,
                     std::vector<std::uint8_t> keep);

/// [object] 1: shows the object, rendered alone, where the scene does not: outside of its rendered mask and the soft
/// edge of it, with more of its weight than within. Where other things stand in front of the object alone, only if no
/// view sees the Gaussian's centre, and with more than 10 times that. 0 for Gaussians that were left out.
std::vector<std::uint8_t> contradicted(const Exec& exec, const AloneViews& in, const AloneObject& object,
                                       const Alone& alone);

/// Leaves the contradicted Gaussians out, and those contradicted then, unless more pixels are wrong without them.
void drop_contradicted(const Exec& exec, const AloneViews& in, const AloneObject& object, Alone& alone);

// Are given masks too small all round? Photos change most where the object ends.

/// One object's masks in all views, and their photos.
class MaskLack {
 public:
  /// `photo` [H, W, 3], of the size of the mask.
  void add(const std::vector<GivenMask>& mask, const ImageF& photo);
  /// The distance outside of the masks, from 3 to 8 px, at which the photos change most, in the mean over its pixels. 0
  /// if that is less than 0.85 of the most within the masks and at their contour, or than twice the change from 12 to
  /// 20 px outside: then the surroundings have texture, and no contour is there.
  int px() const;

 private:
  static constexpr int kInside_px = 8, kOutside_px = 20;
  std::array<double, kOutside_px + kInside_px + 1> change_{};        // [signed distance + kOutside_px], positive inside
  std::array<std::int64_t, kOutside_px + kInside_px + 1> pixels_{};  // the same
};

}  // namespace ngs::finish
