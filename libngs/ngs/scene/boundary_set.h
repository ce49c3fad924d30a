#pragma once
// The boundary Gaussians B of a labelled model: rows, positions and colours.                     Eq. (3)
#include <array>
#include <cstdint>
#include <vector>

#include "ngs/scene/gaussian_cloud.h"
#include "ngs/scene/views.h"

namespace ngs {

struct BoundarySet {
  std::vector<std::uint32_t> row;  // [B] rows of the model, ascending
  std::vector<float> position;     // [B, 3] world, relative to `origin`
  std::vector<float> colour;       // [B, 3] rgb of the constant SH band, not clamped
  std::array<double, 3> origin{};  // the model's, world

  std::int64_t size() const { return std::int64_t(row.size()); }
  Rows<const float, 3> positions() const { return {position.data(), size()}; }
};

/// The usable Gaussians with boundary[i] >= 0.5. `boundary` has one entry per Gaussian (NGS_CHECK).
BoundarySet boundary_set(const GaussianCloud& cloud, const std::vector<float>& boundary);

}  // namespace ngs
