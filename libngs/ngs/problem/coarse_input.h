#pragma once
// A problem at a reduced size, for decisions that need no full resolution, with a cache of decoded photos and masks.
#include <functional>
#include <map>
#include <memory>
#include <mutex>

#include "ngs/problem/problem.h"
#include "ngs/scene/packed_photo.h"
#include "ngs/scene/rle_masks.h"

namespace ngs {

/// Factor by which decisions shrink a scene: 2 from 512 px on, else 1. Wrong masks and Gaussians are visible at half
/// the size too.
int decision_shrink(const Scene& scene);

/// Images have ceil(size / shrink) pixels, and cameras and the low-pass filter match them. Photos and masks are means
/// of shrink x shrink pixels; a mask pixel is unknown if one of these is. Loaded images are cached up to `cache_bytes`,
/// masks as run lengths, photos in 8 bits where that loses nothing. `fine` must outlive this object. For preload() its
/// loaders must be thread-safe.
class CoarseInput {
 public:
  CoarseInput(const Problem& fine, int shrink, std::size_t cache_bytes = 256u << 20);
  CoarseInput(const CoarseInput&) = delete;
  CoarseInput& operator=(const CoarseInput&) = delete;

  const Problem& get() const { return coarse_; }
  /// Loads the masks of the training views and the photos of all views into the cache, on all threads. It stops if the
  /// cache is full, if a stop is requested, or if `keep_loading` returns false, which is called before each image.
  /// Returns the share of images that a stop or `keep_loading` did not exclude.
  double preload(const Exec& exec, const std::function<bool()>& keep_loading = {}) const;
  /// Clears the cache and disables it: every later call loads the image again.
  void clear_cache();

 private:
  template <class T>
  using Cached = std::map<std::size_t, std::shared_ptr<const T>>;  // by view

  ViewMasks load_masks(std::size_t view) const;
  ImageF photo(std::size_t view);
  ViewMasks masks(std::size_t view);
  /// The cached entry of `view`, or the result of load(), which is then cached if it fits.
  template <class T, class Load>
  std::shared_ptr<const T> cached(Cached<T>& cache, std::size_t view, const Load& load);

  const Problem& fine_;
  int shrink_;
  Scene scene_;
  Problem coarse_;
  mutable std::mutex mutex_;  // guards the members below
  Cached<PackedPhoto> photos_;
  Cached<RleMasks> masks_;
  std::size_t cache_bytes_, bytes_ = 0;
};

}  // namespace ngs
