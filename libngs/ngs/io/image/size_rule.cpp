#include "ngs/io/image/size_rule.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace ngs::io {
namespace {

constexpr int kMaxFactor = 16;

/// Whether scaling one side of the larger size to the smaller one's, by at most kMaxFactor, leaves the other side less
/// than a pixel off. Sizes that differ by a pixel or two do not qualify: one image was cropped, not scaled.
bool is_scaled(ImageSize a, ImageSize b) {
  constexpr int kMinSide_px = 32;  // below, one pixel changes the aspect ratio noticeably
  constexpr int kCroppedPx = 2;
  if (std::abs(a.width_px - b.width_px) <= kCroppedPx && std::abs(a.height_px - b.height_px) <= kCroppedPx)
    return false;
  const bool a_is_small = std::int64_t(a.width_px) * a.height_px < std::int64_t(b.width_px) * b.height_px;
  const ImageSize small = a_is_small ? a : b, large = a_is_small ? b : a;
  if (std::min(small.width_px, small.height_px) < kMinSide_px || large.width_px > kMaxFactor * small.width_px)
    return false;
  const double by_width = double(small.width_px) / large.width_px,
               by_height = double(small.height_px) / large.height_px;
  return std::abs(large.height_px * by_width - small.height_px) < 1 ||
         std::abs(large.width_px * by_height - small.width_px) < 1;
}

}  // namespace

SizeRelation relate_sizes(ImageSize file, ImageSize camera, double image_scale) {
  SizeRelation relation;
  relation.same = file == camera;
  relation.allowed = relation.same;
  relation.larger = file.width_px > camera.width_px || file.height_px > camera.height_px;
  const auto matches = [&](double factor) {  // floor, ceil and round of the exact size differ from it by < 1 px
    return std::abs(file.width_px * factor - camera.width_px) < 1 &&
           std::abs(file.height_px * factor - camera.height_px) < 1;
  };
  for (int k = 1; k <= kMaxFactor && !relation.allowed; ++k)
    for (const double scale : {1.0, image_scale})
      relation.allowed |= matches(scale * k) || matches(scale / k) ||
                          // both were rounded: the file from full size / k, the camera from full size · scale
                          (std::abs(camera.width_px / scale / k - file.width_px) < 1 &&
                           std::abs(camera.height_px / scale / k - file.height_px) < 1);
  relation.allowed |= is_scaled(file, camera);
  return relation;
}

SizeRelation relate_mask_size(ImageSize file, ImageSize camera, double image_scale) {
  SizeRelation relation = relate_sizes(file, camera, image_scale);
  const auto within = [&](double scale, double slack_px) {
    return std::abs(file.width_px * scale - camera.width_px) <= slack_px &&
           std::abs(file.height_px * scale - camera.height_px) <= slack_px;
  };
  constexpr int kMinSide_px = 100;  // below, one pixel changes the aspect ratio noticeably
  if (std::min(camera.width_px, camera.height_px) < kMinSide_px) return relation;
  // the camera's size is the photo's, scaled and rounded to nearest
  relation.allowed |= within(1, 1) || within(image_scale, image_scale + 0.5);
  return relation;
}

bool is_turned(ImageSize file, ImageSize camera, double image_scale) {
  return !relate_mask_size(file, camera, image_scale).allowed &&
         relate_mask_size({file.height_px, file.width_px}, camera, image_scale).allowed;
}

}  // namespace ngs::io
