#pragma once
// A method's input at a fraction of its size, for decisions that need no full resolution, and with photos and
// masks that are decoded once.
#include <map>

#include "ngs/stages/method.h"

namespace ngs {

/// Cameras and the low-pass filter are those of images of ceil(size / shrink) pixels; photos and masks are
/// the means of shrink x shrink pixels, unknown where one of them is. Loads only; nothing is written back.
/// What was loaded is kept, up to 512 MiB. Not for use by several threads at once. `fine` must outlive it.
class CoarseInput {
 public:
  CoarseInput(const MethodInput& fine, int shrink);
  CoarseInput(const CoarseInput&) = delete;
  CoarseInput& operator=(const CoarseInput&) = delete;

  const MethodInput& get() const { return coarse_; }

 private:
  ImageF photo(std::size_t view);
  ViewMasks masks(std::size_t view);
  bool keep(std::size_t floats);

  const MethodInput& fine_;
  int shrink_;
  Scene scene_;
  MethodInput coarse_;
  std::map<std::size_t, ImageF> photos_;
  std::map<std::size_t, ViewMasks> masks_;
  std::size_t bytes_ = 0;
};

}  // namespace ngs
