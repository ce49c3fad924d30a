#pragma once
// Masks as the page reads them.
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/ops/metrics.h"

namespace ngs::cli {

struct Plane {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> data;  // empty: there is no such mask
  bool empty() const { return data.empty(); }
  MaskPlane view() const { return {data.data(), width_px, height_px}; }
};

/// `id` as in ShownView. Pictures with layers are not shown.
Plane read_plane(const std::string& path, std::uint32_t id);
Plane fitted(const Plane& plane, int width_px, int height_px);

}  // namespace ngs::cli
