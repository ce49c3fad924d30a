#pragma once
// Cache of the decoded photos and masks of the training views, of limited size. With a device, they are copied once.
#include <algorithm>
#include <memory>
#include <vector>

#include "ngs/cut/training/joint_options.h"
#include "ngs/ops/image/pixel_window.h"
#include "ngs/ops/losses/photometric.h"
#include "ngs/ops/optim/resident.h"
#include "ngs/ops/splat/step_tiles.h"
#include "ngs/problem/problem.h"

namespace ngs {

class ViewCache {
 public:
  struct View {
    ImageF photo;
    ViewMasks masks;
    PixelRect object;  // box about the object; empty if the mask is empty
    TileFlags near;    // contour_tiles(), with JointOptions::at_contours
  };
  ViewCache(const Exec& exec, const Problem& input, bool at_contours)
      : input_(input), at_contours_(at_contours), view_(input.views.size()), resident_(exec) {}

  bool keeps(std::size_t n) const { return view_[n] != nullptr; }

  /// View `n` of input.views. Views that do not fit into the cache are returned in `scratch`.
  const View& load(Monitor& monitor, std::size_t n, bool with_photo, View& scratch) {
    if (view_[n]) return *view_[n];
    const auto timed = monitor.scope("load view");
    scratch.masks = input_.load_masks(input_.views[n]);
    if (with_photo) scratch.photo = input_.load_photo(input_.views[n]);
    scratch.object = object_box(scratch.masks);
    if (at_contours_) scratch.near = contour_tiles(scratch.masks);
    std::size_t bytes = scratch.photo.data.size() * sizeof(float) + scratch.masks.known.size();
    for (const auto& target : scratch.masks.target) bytes += target.size() * sizeof(float);
    if (bytes_ + bytes > kBytes) return scratch;
    bytes_ += bytes;
    view_[n] = std::make_unique<View>(std::move(scratch));
    const View& view = *view_[n];
    resident_.add_input(view.photo.data), resident_.add_input(view.masks.known), resident_.add_input(view.near);
    for (const std::vector<float>& target : view.masks.target) resident_.add_input(target);
    return view;
  }

 private:
  static constexpr std::size_t kBytes = 512u << 20;

  static PixelRect object_box(const ViewMasks& masks) {
    if (!masks.available) return {};
    const PixelWindow w = window_of(masks.target, masks.width_px, masks.height_px, kAnchorMargin_px);
    return {w.x0, w.y0, w.x0 + w.w, w.y0 + w.h};
  }

  const Problem& input_;
  const bool at_contours_;
  std::vector<std::unique_ptr<View>> view_;
  std::size_t bytes_ = 0;
  Resident resident_;  // the cached views; others are copied in each step
};

}  // namespace ngs
