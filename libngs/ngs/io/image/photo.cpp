#include "ngs/io/image/photo.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/io/files/mapped_file.h"

namespace ngs::io {
namespace {

/// The decoded file, with its size checked against the camera; empty if the view has no photo.
PackedPhoto checked_photo(const Scene& scene, std::size_t view) {
  NGS_CHECK(view < scene.views.size(), "view index");
  const SceneView& v = scene.views[view];
  if (v.image_path.empty()) return {};
  PackedPhoto photo =
      read_photo(v.image_path, has_mask_in_photo(v) ? std::nullopt : std::optional(background_of(scene)));
  const ImageSize camera{v.camera.width_px, v.camera.height_px}, file{photo.width_px(), photo.height_px()};
  const SizeRelation relation = relate_sizes(file, camera, scene.image_scale);
  if (!relation.allowed || (!relation.same && !relation.larger))
    throw Error(ErrorCode::kInconsistent,
                v.image_path + ": photo of " + to_string(file) + " px, expected the camera's " + to_string(camera) +
                    " px or a larger one of the same shape",
                "import the scene again with the folder of these photos: ngs-scene import SOURCE --images DIR");
  return photo;
}

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

PackedPhoto read_packed_photo(const Scene& scene, std::size_t view) {
  PackedPhoto photo = checked_photo(scene, view);
  const Camera& camera = scene.views[view].camera;
  if (photo.empty() || (photo.width_px() == camera.width_px && photo.height_px() == camera.height_px)) return photo;
  return resize_area(photo.rgb(), camera.width_px, camera.height_px);
}

ImageF load_photo(const Scene& scene, std::size_t view) { return read_packed_photo(scene, view).rgb(); }

double packed_photo_bytes(const Scene& scene, std::size_t view) {
  const SceneView& v = scene.views.at(view);
  if (v.image_path.empty()) return 0;
  const double pixels = double(v.camera.width_px) * v.camera.height_px;
  const MappedFile file = map_regular_file(v.image_path);
  const auto header = parse_image_header(file.bytes(), v.image_path);
  const bool as_in_file = header && header->width_px == v.camera.width_px && header->height_px == v.camera.height_px;
  return 3 * pixels * (!as_in_file ? double(sizeof(float)) : header->bits > 8 ? 2 : 1);
}

ImageF load_fine_photo(const Scene& scene, std::size_t view, int max_factor) {
  ImageF photo = checked_photo(scene, view).rgb();
  const Camera& camera = scene.views[view].camera;
  if (photo.empty() || photo.width_px <= max_factor * camera.width_px + max_factor) return photo;
  return resize_area(photo, max_factor * camera.width_px, max_factor * camera.height_px);
}

ImageSize full_size(const Scene& scene, std::size_t view) {
  const SceneView& v = scene.views.at(view);
  const auto scaled = [](ImageSize size, double scale) {
    return ImageSize{scaled_size_px(size.width_px, scale), scaled_size_px(size.height_px, scale)};
  };
  const ImageSize camera{v.camera.width_px, v.camera.height_px};
  if (is_regular_file(v.image_path)) {
    const ImageSize photo = read_image_size(v.image_path);
    if (scaled(photo, scene.image_scale) == camera) return photo;
  }
  return scaled(camera, 1 / scene.image_scale);
}

bool photo_is_transparent(const Scene& scene, std::size_t view) {
  const SceneView& v = scene.views[view];
  return !v.image_path.empty() && !has_mask_in_photo(v) && is_transparent(v.image_path);
}

bool has_mask_in_photo(const SceneView& view) { return !view.image_path.empty() && view.mask_path == view.image_path; }

ImageF load_alpha(const SceneView& view) {
  if (view.image_path.empty()) return {};
  const RawMask raw = read_mask_raw(view.image_path, Palette::kColours);
  if (raw.channels != 4) return {};
  ImageF alpha(raw.width_px, raw.height_px, 1);
  for (std::size_t p = 0; p < alpha.data.size(); ++p)
    alpha.data[p] = float(raw.data[4 * p + 3]) / (raw.bits == 8 ? 255.f : 65535.f);
  return resize_area(alpha, view.camera.width_px, view.camera.height_px);
}

ImageF PhotoCache::load(std::size_t view) {
  if (cached_views_.count(view) == 0) return load_photo(scene_, view);
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = cache_.find(view); found != cache_.end()) return found->second.rgb();
  }
  PackedPhoto photo = read_packed_photo(scene_, view);  // outside the lock, so that threads load in parallel
  ImageF rgb = photo.rgb();
  const std::lock_guard lock(mutex_);
  const std::size_t bytes = photo.bytes();
  if (bytes_ + bytes <= max_bytes_ && cache_.emplace(view, std::move(photo)).second) bytes_ += bytes;
  return rgb;
}

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
