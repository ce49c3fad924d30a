#pragma once
// Masks as the page reads them.
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/ops/image/metrics.h"
#include "run_folder.h"

namespace ngs::cli {

struct Plane {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> data;     // empty: there is no such mask
  std::vector<std::uint8_t> is_void;  // of a true label map with void pixels
  bool empty() const { return data.empty(); }
  MaskPlane view() const { return {data.data(), width_px, height_px}; }
};

/// `id` as in ShownView. Pictures with layers are not shown.
Plane read_plane(const std::string& path, std::uint32_t id);
/// With its void pixels.
Plane read_truth(const ShownView& view);
/// The truth, in its void pixels the prediction of the same size: no pixel there is wrong.
Plane closest_truth(Plane truth, const Plane& predicted);
Plane fitted(const Plane& plane, int width_px, int height_px);

}  // namespace ngs::cli
