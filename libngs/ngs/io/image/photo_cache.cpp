#include "ngs/io/image/photo_cache.h"

namespace ngs::io {

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

}  // namespace ngs::io
