#pragma once
// A method's input at a fraction of its size, for decisions that need no full resolution, and with photos and
// masks that are decoded once.
#include <functional>
#include <map>
#include <memory>
#include <mutex>

#include "ngs/problem/problem.h"
#include "ngs/scene/rle_masks.h"

namespace ngs {

/// By how much decisions shrink a scene: whether a mask or a Gaussian is wrong shows at half the size, where that still
/// is a picture.
int decision_shrink(const Scene& scene);

/// Cameras and the low-pass filter are those of images of ceil(size / shrink) pixels; photos and masks are
/// the means of shrink x shrink pixels, unknown where one of them is. Loads only; nothing is written back.
/// What was loaded is kept, masks run by run, up to `cache_bytes`. `fine` must outlive it, and load for several
/// threads at once where preload() is used.
class CoarseInput {
 public:
  CoarseInput(const Problem& fine, int shrink, std::size_t cache_bytes = 256u << 20);
  CoarseInput(const CoarseInput&) = delete;
  CoarseInput& operator=(const CoarseInput&) = delete;

  const Problem& get() const { return coarse_; }
  /// Loads the masks of the input's views and the photos of all that have one, on all threads, while there is room,
  /// nobody asks to stop and `go_on` says so, which every thread asks before each of them. Returns the share that was
  /// not refused.
  double preload(const Exec& exec, const std::function<bool()>& go_on = {}) const;
  /// Lets go of what was kept, and keeps nothing from here on: all is loaded where it is asked for.
  void forget();

 private:
  template <class T>
  using Cached = std::map<std::size_t, std::shared_ptr<const T>>;  // by view

  ViewMasks load_masks(std::size_t view) const;
  ImageF photo(std::size_t view);
  ViewMasks masks(std::size_t view);
  /// What is kept of `view`, or loaded by load() and then kept if there is room.
  template <class T, class Load>
  std::shared_ptr<const T> cached(Cached<T>& kept, std::size_t view, const Load& load);

  const Problem& fine_;
  int shrink_;
  Scene scene_;
  Problem coarse_;
  mutable std::mutex mutex_;  // of what follows
  Cached<ImageF> photos_;
  Cached<RleMasks> masks_;
  std::size_t kept_bytes_, bytes_ = 0;
};

}  // namespace ngs
