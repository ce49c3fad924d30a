#pragma once
// Are given masks too small all round? Photos change most where the object ends.
#include <array>

#include "ngs/edit/finish/support_view.h"

namespace ngs::finish {

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
