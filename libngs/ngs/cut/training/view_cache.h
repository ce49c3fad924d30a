#pragma once
// Cache of the photos and masks of the training views, of limited size: packed, or, with a device, copied to it once.
#include <algorithm>
#include <memory>
#include <vector>

#include "ngs/cut/training/joint_options.h"
#include "ngs/ops/image/pixel_window.h"
#include "ngs/ops/losses/photometric.h"
#include "ngs/ops/optim/resident.h"
#include "ngs/ops/optim/rows.h"
#include "ngs/ops/splat/step_tiles.h"
#include "ngs/problem/problem.h"
#include "ngs/scene/packed_photo.h"
#include "ngs/scene/rle_masks.h"

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
      : exec_(exec),
        input_(input),
        at_contours_(at_contours),
        view_(input.views.size()),
        packed_(input.views.size()),
        resident_(exec) {}

  /// Whether the arrays of view `n` stay on the device.
  bool keeps(std::size_t n) const { return view_[n] != nullptr; }

  /// View `n` of input.views, until the next call.
  const View& load(Monitor& monitor, std::size_t n, bool with_photo) {
    if (view_[n]) return *view_[n];
    if (packed_[n]) return unpacked(*packed_[n]);
    const auto timed = monitor.scope("load view");
    shown_.masks = input_.load_masks(input_.views[n]);
    shown_.photo = with_photo ? input_.load_photo(input_.views[n]) : ImageF();
    shown_.object = object_box(shown_.masks);
    shown_.near = at_contours_ ? contour_tiles(shown_.masks) : TileFlags();
    return rows_are_on_device(exec_) ? keep(n) : pack(n);
  }

 private:
  static constexpr std::size_t kBytes = 512u << 20;
  struct Packed {
    PackedPhoto photo;
    RleMasks masks;
    PixelRect object;
    TileFlags near;
  };

  const View& unpacked(const Packed& packed) {
    packed.photo.rgb(shown_.photo);
    packed.masks.unpack(shown_.masks);
    shown_.object = packed.object;
    shown_.near = packed.near;
    return shown_;
  }

  /// Caches `shown_` as view n if it fits. Once a view did not fit, none is packed: packing would slow every step.
  const View& pack(std::size_t n) {
    if (full_) return shown_;
    Packed packed{PackedPhoto(shown_.photo), RleMasks(shown_.masks), shown_.object, shown_.near};
    full_ = !fits(packed.photo.bytes() + packed.masks.bytes());
    if (!full_) packed_[n] = std::make_unique<Packed>(std::move(packed));
    return shown_;
  }

  /// Moves `shown_` to the device as view n, if it fits.
  const View& keep(std::size_t n) {
    std::size_t bytes = shown_.photo.data.size() * sizeof(float) + shown_.masks.known.size();
    for (const auto& target : shown_.masks.target) bytes += target.size() * sizeof(float);
    if (!fits(bytes)) return shown_;
    view_[n] = std::make_unique<View>(std::move(shown_));
    const View& view = *view_[n];
    resident_.add_input(view.photo.data);
    resident_.add_input(view.masks.known);
    resident_.add_input(view.near);
    for (const std::vector<float>& target : view.masks.target) resident_.add_input(target);
    return view;
  }

  bool fits(std::size_t bytes) {
    if (bytes_ + bytes > kBytes) return false;
    bytes_ += bytes;
    return true;
  }

  static PixelRect object_box(const ViewMasks& masks) {
    if (!masks.available) return {};
    const PixelWindow w = window_of(masks.target, masks.width_px, masks.height_px, kAnchorMargin_px);
    return {w.x0, w.y0, w.x0 + w.w, w.y0 + w.h};
  }

  const Exec& exec_;
  const Problem& input_;
  const bool at_contours_;
  View shown_;                                   // the last view, unless it is kept on a device
  std::vector<std::unique_ptr<View>> view_;      // on a device
  std::vector<std::unique_ptr<Packed>> packed_;  // elsewhere
  std::size_t bytes_ = 0;
  bool full_ = false;  // a view did not fit into the remaining space
  Resident resident_;  // the cached views; others are copied in each step
};

}  // namespace ngs
