#pragma once
// Masks of a labelled model walked to the edges of the photos, view by view.             PAPER.md §5.10
#include "ngs/ops/edge_walk.h"
#include "ngs/scene/packed_masks.h"
#include "ngs/stages/method.h"

namespace ngs {

struct PixelWindow {
  int x0 = 0, y0 = 0, w = 0, h = 0;
};

/// What a round trains a view on: the window and, in it, the walked masks.
struct WalkedView {
  PixelWindow window;
  double detail = 0;  // size of the photo relative to the camera's, before any enlarging
  PackedMasks masks;  // of the window's size
  // Mean boundary IoU with the view's own masks; only where the view supervises and has them.
  bool compared = false;
  double rendered_biou = 0, walked_biou = 0;
  double own_contrast = 0, walked_contrast = 0;  // of the photo across the contours
};

struct WalkSetup {
  const EdgeWalkOptions& walk;
  double margin_px;  // of the windows
  const MethodInput& input;
  int detail = 1;  // photos with fewer pixels than this many times the camera's size are enlarged to it
};

struct LabelledModel {
  const GaussianCloud& cloud;
  const std::vector<LabelColumns>& labels;
};

/// Photos are read at up to twice the camera's size, and enlarged to setup.detail times it. [scene views] the given views
/// walked, the others empty, as is a view without a photo. The masks of the views in `compared` are loaded and compared with; no other
/// mask is read.
std::vector<WalkedView> walk_views(const Exec& exec, const WalkSetup& setup, const LabelledModel& model,
                                   const std::vector<std::size_t>& views,
                                   const std::vector<std::size_t>& compared);

/// Whether some view that was compared was walked in a photo of less than `detail` times the camera's size.
bool could_enlarge(const std::vector<WalkedView>& walked, int detail);
/// walked_biou of the one less that of the other, of the views that were compared in both.
std::vector<double> gains_over(const std::vector<WalkedView>& walked, const std::vector<WalkedView>& other);

/// walked_biou - rendered_biou of the views that were compared.
std::vector<double> walk_gains(const std::vector<WalkedView>& walked);

/// Contours with less than this of the walked ones' contrast do not lie on edges. On the synthetic recipes
/// masks that are exact have 0.89 to 1.03, those wrong by 2 px 0.36 to 0.66.
inline constexpr double kOffEdges = 0.75;
/// Whether the given masks' contours do not, on the mean of the views that were compared.
bool masks_beside_edges(const std::vector<WalkedView>& walked);

/// The walked masks of a view of the scene's size `w` x `h`, whole: nothing is there outside of the window.
ViewMasks whole_masks(const WalkedView& walked, int w, int h);

/// The window of a plane of `channels` interleaved channels.
template <class T>
std::vector<T> cropped(const std::vector<T>& plane, int width_px, int channels, const PixelWindow& win) {
  std::vector<T> out;
  out.reserve(std::size_t(win.w) * std::size_t(win.h) * std::size_t(channels));
  for (int y = win.y0; y < win.y0 + win.h; ++y) {
    const auto row = plane.begin() + (std::ptrdiff_t(y) * width_px + win.x0) * channels;
    out.insert(out.end(), row, row + std::ptrdiff_t(win.w) * channels);
  }
  return out;
}

Camera window_camera(Camera camera, const PixelWindow& win);

/// The pixels where any target exceeds 0, and a margin; empty where there are none.
PixelWindow window_of(const std::vector<std::vector<float>>& targets, int w, int h, int margin);

}  // namespace ngs
