#include "ngs/edit/finish/mask_lack.h"

#include <algorithm>
#include <cmath>

#include "ngs/core/check.h"
#include "ngs/ops/image/metrics.h"
#include "ngs/scene/view_prompt.h"

namespace ngs::finish {
namespace {

constexpr int kLeast_px = 3;  // the margins of SupportView cover smaller errors
constexpr int kMost_px = 8;
constexpr int kFar_px = 12;        // pixels at least so far outside are surroundings
constexpr double kOutside = 0.85;  // minimum gradient outside, relative to the largest mean gradient inside
constexpr double kFarTimes = 2;    // the same, relative to the mean gradient of the surroundings

/// Length of the photo's gradient, summed over the channels; not at the image's border.
double change_at(const ImageF& photo, int x, int y) {
  double across = 0, down = 0;
  for (int c = 0; c < photo.channels; ++c) {
    across += std::abs(double(photo.at(x + 1, y, c)) - double(photo.at(x - 1, y, c)));
    down += std::abs(double(photo.at(x, y + 1, c)) - double(photo.at(x, y - 1, c)));
  }
  return std::hypot(across, down);
}

}  // namespace

void MaskLack::add(const std::vector<GivenMask>& mask, const ImageF& photo) {
  const int w = photo.width_px, h = photo.height_px;
  NGS_CHECK(mask.size() == std::size_t(w) * std::size_t(h), "a photo has the size of its mask");
  PixelMask object(mask.size());
  for (std::size_t p = 0; p < mask.size(); ++p) object[p] = mask[p] == GivenMask::kObject;
  const std::vector<std::int32_t> inside = signed_distance({object.data(), w, h});
  for (int y = 1; y + 1 < h; ++y)
    for (int x = 1; x + 1 < w; ++x) {
      const std::size_t p = std::size_t(y) * std::size_t(w) + std::size_t(x);
      if (inside[p] < -kOutside_px || inside[p] > kInside_px || mask[p] == GivenMask::kUnknown) continue;
      const auto at = std::size_t(inside[p] + kOutside_px);
      change_[at] += change_at(photo, x, y);
      ++pixels_[at];
    }
}

int MaskLack::px() const {
  double within = 0, outside = 0;  // the largest mean change up to a pixel outside of the contour, and farther outside
  double far = 0;
  std::int64_t far_pixels = 0;
  int lack = 0;
  for (int inside = kInside_px; inside >= -kOutside_px; --inside) {
    const auto at = std::size_t(inside + kOutside_px);
    const double mean = pixels_[at] > 0 ? change_[at] / double(pixels_[at]) : 0;
    if (inside >= -1) {
      within = std::max(within, mean);
    } else if (inside <= -kFar_px) {
      far += change_[at];
      far_pixels += pixels_[at];
    } else if (inside <= -kLeast_px && inside >= -kMost_px && mean > outside) {
      outside = mean;
      lack = -inside;
    }
  }
  if (outside <= kOutside * within) return 0;
  return outside * double(far_pixels) > kFarTimes * far ? lack : 0;
}

}  // namespace ngs::finish
