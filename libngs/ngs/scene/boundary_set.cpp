#include "ngs/scene/boundary_set.h"

#include "ngs/core/check.h"
#include "ngs/math/sh.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs {

BoundarySet boundary_set(const GaussianCloud& cloud, const std::vector<float>& boundary) {
  NGS_CHECK(boundary.size() == std::size_t(cloud.size()), "one boundary flag per Gaussian");
  BoundarySet set;
  set.origin = cloud.origin;
  for (std::size_t i = 0; i < boundary.size(); ++i) {
    if (!is_set(boundary[i]) || !cloud.usable[i]) continue;
    set.row.push_back(std::uint32_t(i));
    for (std::size_t c = 0; c < 3; ++c) {
      set.position.push_back(cloud.position[i * 3 + c]);
      set.colour.push_back(colour_of_dc(cloud.sh_dc[i * 3 + c]));
    }
  }
  return set;
}

}  // namespace ngs
