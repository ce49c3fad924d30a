#pragma once
// Masks read for the page.
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
/// True mask with void pixels.
Plane read_truth(const ShownView& view);
/// Replaces void pixels of `truth` by the prediction (same size), so that they never count as wrong.
Plane closest_truth(Plane truth, const Plane& predicted);
/// Resized to the given size by nearest neighbour.
Plane fitted(const Plane& plane, int width_px, int height_px);

}  // namespace ngs::cli
