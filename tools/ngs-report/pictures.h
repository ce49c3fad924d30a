#pragma once
// Photos with mask outlines: JPEG data URIs under inline SVG, sharp at any zoom.
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/ops/image/metrics.h"
#include "run_folder.h"

namespace ngs::cli {

struct Plane {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> data;     // empty: no mask
  std::vector<std::uint8_t> is_void;  // void pixels of a true label map; may be empty
  bool empty() const { return data.empty(); }
  MaskPlane view() const { return {data.data(), width_px, height_px}; }
};

/// `id` as in ShownView. Empty for pictures with layers (EXR).
Plane read_plane(const std::string& path, std::uint32_t id);
Plane read_truth(const ShownView& view);
/// Replaces void pixels of `truth` by the prediction (same size), so that they never count as wrong.
Plane closest_truth(Plane truth, const Plane& predicted);
/// Resized to the given size by nearest neighbour.
Plane fitted(const Plane& plane, int width_px, int height_px);

struct PictureOptions {
  int sheet_width_px = 360, crop_side_px = 96;
  double budget_mib = 4.2;  // picture bytes on the whole page
  int zoomed_views = 4;
};

/// Makes figures until the picture budget of the page is spent.
class Pictures {
 public:
  explicit Pictures(const PictureOptions& options) : options_(options) {}

  /// The contact sheet of a run, worst views first, and crops of the worst. Adds unreadable pictures to `run.problems`.
  std::string sheet(RunFolder& run);
  std::string crops(RunFolder& run);
  /// The input mask of each view over its photo, within the remaining budget.
  std::string given_masks(RunFolder& run);

  /// Takes `bytes` from the budget; false if they exceed it.
  bool spend(std::size_t bytes);
  int zoomed_views() const { return options_.zoomed_views; }

 private:
  PictureOptions options_;
  std::size_t spent_bytes_ = 0;
};

}  // namespace ngs::cli
