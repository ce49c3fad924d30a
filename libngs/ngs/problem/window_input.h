#pragma once
// A problem cropped to a window of each view, so that the cost of an object does not depend on the size of the scene.
#include <memory>
#include <vector>

#include "ngs/ops/image/pixel_window.h"
#include "ngs/problem/problem.h"
#include "ngs/scene/rle_masks.h"

namespace ngs {

/// Windows about the visible objects.
struct ObjectWindows {
  std::vector<PixelWindow> window;  // [views of the scene] empty (w = 0): no object is visible in the view
  std::vector<RleMasks> masks;      // [views of the scene] uncropped masks
  double outside = 0;               // share of the pixels of all views outside the windows, in [0, 1]
};

/// Windows that contain the masks of the training views and, in all views with masks or a photo, the labelled Gaussians
/// rendered alone. A window has a margin of a fifth of its longer side, 48 to 64 px, and is aligned to tiles. At each
/// side, up to kOutlierShare of an object's rendered pixels are ignored as outliers. A view has no window if its masks
/// are empty and other Gaussians occlude all objects. The result is empty if a stop was requested. `of_masks`: result
/// of windows_of_masks(); empty: computed here.
ObjectWindows object_windows(const Exec& exec, const Problem& problem, ObjectWindows of_masks = {});
inline constexpr double kOutlierShare = 0.002;

/// The boxes of the masks alone, without margins. Here `outside` is an upper bound: labelled Gaussians that show
/// outside the masks will enlarge the windows.
ObjectWindows windows_of_masks(const Exec& exec, const Problem& problem);

class WindowInput {
 public:
  /// Copies `uncropped`; the objects that it refers to must outlive this object.
  WindowInput(const Problem& uncropped, std::shared_ptr<const ObjectWindows> windows);
  WindowInput(const WindowInput&) = delete;
  WindowInput& operator=(const WindowInput&) = delete;

  /// The problem with cropped cameras, masks and photos. A view without a window is no training view and has no photo.
  const Problem& cropped() const { return cropped_; }
  const Problem& uncropped() const { return uncropped_; }

 private:
  ViewMasks masks(std::size_t view) const;
  ImageF cropped_photo(const ImageF& photo, std::size_t view) const;

  Problem uncropped_;
  std::shared_ptr<const ObjectWindows> windows_;
  Scene scene_;
  Problem cropped_;
};

}  // namespace ngs
