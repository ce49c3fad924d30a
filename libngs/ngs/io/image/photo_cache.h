#pragma once
// A cache of decoded photos, for steps that load a photo several times, up to a memory limit.
#include <map>
#include <mutex>
#include <set>
#include <vector>

#include "ngs/io/image/photo.h"

namespace ngs::io {

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

}  // namespace ngs::io
