#pragma once
// The photo of a view at its camera's size.
#include <cstddef>
#include <map>
#include <mutex>
#include <set>
#include <vector>

#include "ngs/io/image/image_file.h"
#include "ngs/scene/scene.h"

namespace ngs::io {

/// [H, W, 3] RGB in [0, 1]. Transparent pixels are composited over the scene's background, as trainers do. A file
/// larger than the camera by an integer factor or by the scene's image_scale is reduced by area average; any other size
/// is kInconsistent. Empty image: the view has no photo.
ImageF load_photo(const Scene& scene, std::size_t view);

/// The same, as the file's samples if the file has the camera's size.
PackedPhoto read_packed_photo(const Scene& scene, std::size_t view);
/// Memory [bytes] that read_packed_photo() will need, from the file's header alone; 0 if the view has no photo.
double packed_photo_bytes(const Scene& scene, std::size_t view);

/// The same with up to `max_factor` times the camera's pixels per side, if the file has that many.
ImageF load_fine_photo(const Scene& scene, std::size_t view, int max_factor = 2);
/// The size of the view's photo, which is the camera's size / image_scale up to rounding. That quotient is returned if
/// there is no photo or it is not the one with which the scene was imported.
ImageSize full_size(const Scene& scene, std::size_t view);

/// Whether the photo is transparent somewhere, so that the scene's background is visible in it.
bool photo_is_transparent(const Scene& scene, std::size_t view);

/// Whether the view's mask is the alpha channel of its photo, which is then loaded without it.
bool has_mask_in_photo(const SceneView& view);
/// [H, W, 1] alpha of the photo in [0, 1], at the camera's size; empty: no photo, or it has no alpha.
ImageF load_alpha(const SceneView& view);

// A cache of decoded photos, for steps that load a photo several times, up to a memory limit.
class PhotoCache {
 public:
  /// Caches the photos of `views`, in order of first use, while they take at most `max_bytes` together. All other
  /// photos are decoded on each call. `scene` must outlive the cache; its background and working size must not change
  /// once a photo is cached.
  PhotoCache(const Scene& scene, const std::vector<std::size_t>& views, std::size_t max_bytes = std::size_t(256) << 20)
      : scene_(scene), cached_views_(views.begin(), views.end()), max_bytes_(max_bytes) {}

  /// As load_photo(scene, view), from any thread.
  ImageF load(std::size_t view);

  std::size_t cache_bytes() const { return bytes_; }

 private:
  const Scene& scene_;
  const std::set<std::size_t> cached_views_;
  const std::size_t max_bytes_;
  std::mutex mutex_;  // protects the members below
  std::map<std::size_t, PackedPhoto> cache_;
  std::size_t bytes_ = 0;
};

// Decides which file sizes show "the same picture" as a camera's image.

/// Relation of a file's size to the camera's. `allowed`: both sides differ by the same integer factor k (1..16, either
/// direction), with or without the scene's image_scale, each side within 1 px of rounding; or by any factor up to 16,
/// if each side has at least 32 px and matching one side leaves the other less than 1 px off.
struct SizeRelation {
  bool allowed = false;
  bool same = false;
  bool larger = false;  // the file has more pixels
};

SizeRelation relate_sizes(ImageSize file, ImageSize camera, double image_scale);
/// The same for masks, which may also be 1 px wider, narrower, higher or lower than the photo or the camera's image,
/// because tools that scale photos round differently (sides of 100 px and more, where that is at most 1 %). Photos may
/// not: their pixels must match the camera's exactly.
SizeRelation relate_mask_size(ImageSize file, ImageSize camera, double image_scale);

/// Whether the file would fit the camera after a rotation by 90 degrees.
bool is_turned(ImageSize file, ImageSize camera, double image_scale);

}  // namespace ngs::io
