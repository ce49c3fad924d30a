#pragma once
// Photos that several steps ask for, decoded once as far as memory is set aside for them.
#include <map>
#include <mutex>
#include <set>
#include <vector>

#include "ngs/io/image/photo.h"

namespace ngs::io {

class PhotoCache {
 public:
  /// Keeps the photos of `views`, in the order in which they are asked for, while all of them take at most
  /// `most_bytes`. Others are decoded each time: keep what is asked for more than once. `scene` must outlive the cache;
  /// its background and its working size stay as they are once a photo is kept.
  PhotoCache(const Scene& scene, const std::vector<std::size_t>& views, std::size_t most_bytes = std::size_t(256) << 20)
      : scene_(scene), to_keep_(views.begin(), views.end()), most_bytes_(most_bytes) {}

  /// As load_photo(scene, view), from any thread.
  ImageF load(std::size_t view);

  std::size_t cache_bytes() const { return bytes_; }

 private:
  const Scene& scene_;
  const std::set<std::size_t> to_keep_;
  const std::size_t most_bytes_;
  std::mutex mutex_;  // of what follows
  std::map<std::size_t, PackedPhoto> cache_;
  std::size_t bytes_ = 0;
};

}  // namespace ngs::io
