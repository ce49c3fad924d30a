#pragma once
// A problem in a window of each view: what an object costs does not depend on how much of a scene is beside it.
#include <memory>
#include <vector>

#include "ngs/problem/pixel_window.h"
#include "ngs/problem/problem.h"
#include "ngs/scene/rle_masks.h"

namespace ngs {

/// Where the objects of a problem show, and with what margin.
struct ObjectWindows {
  std::vector<PixelWindow> window;  // [views of the scene], w = 0: shows nothing
  std::vector<RleMasks> masks;      // [views of the scene] of the whole views, as they were loaded
  double outside = 0;               // share of the pixels of all views that no window holds, in [0, 1]
};

/// About the masks of the training views, and about the labelled Gaussians drawn alone in all views that have masks or
/// a photo: a fifth of the longer side more on each side, 24 to 64 px, then on to multiples of a tile. Of what lies
/// apart at the edges of an object's picture up to kStrayShare a side is left out. A view whose mask shows none
/// of them has no window where other Gaussians hide them all. Empty where it was asked to stop.
/// `of_masks`: of windows_of_masks(); empty: worked out here.
ObjectWindows object_windows(const Exec& exec, const Problem& problem, ObjectWindows of_masks = {});
inline constexpr double kStrayShare = 0.002;

/// The boxes of the masks alone, without margin. `outside` is a bound: what labelled Gaussians show beside them only
/// lowers it.
ObjectWindows windows_of_masks(const Exec& exec, const Problem& problem);

class WindowInput {
 public:
  /// `whole` is copied; what it refers to must outlive this.
  WindowInput(const Problem& whole, std::shared_ptr<const ObjectWindows> windows);
  WindowInput(const WindowInput&) = delete;
  WindowInput& operator=(const WindowInput&) = delete;

  /// Cameras, masks and photos of the windows. Views that show nothing supervise nothing, and have no photo.
  const Problem& get() const { return in_windows_; }
  const Problem& whole() const { return whole_; }

 private:
  ViewMasks masks(std::size_t view) const;
  ImageF cropped_photo(const ImageF& whole, std::size_t view) const;

  Problem whole_;
  std::shared_ptr<const ObjectWindows> windows_;
  Scene scene_;
  Problem in_windows_;
};

}  // namespace ngs
