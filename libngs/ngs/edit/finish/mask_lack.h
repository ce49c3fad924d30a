#pragma once
// Measures by how many pixels given masks are too small. Photos have their largest gradients at the contour.
#include <array>

#include "ngs/edit/finish/support_view.h"

namespace ngs::finish {

/// One object's masks in all views, and their photos.
class MaskLack {
 public:
  /// `photo` [H, W, 3], of the size of the mask.
  void add(const std::vector<GivenMask>& mask, const ImageF& photo);
  /// The distance outside the masks, 3 to 8 px, at which the photos' mean gradient is largest. 0 in two cases: that
  /// gradient is at most 0.85 of the largest mean gradient inside the masks and at their contour; or it is at most
  /// twice the mean gradient at 12 to 20 px, and so may be texture of the surroundings.
  int px() const;

 private:
  static constexpr int kInside_px = 8, kOutside_px = 20;
  std::array<double, kOutside_px + kInside_px + 1> change_{};        // [signed distance + kOutside_px], positive inside
  std::array<std::int64_t, kOutside_px + kInside_px + 1> pixels_{};  // the same
};

}  // namespace ngs::finish
