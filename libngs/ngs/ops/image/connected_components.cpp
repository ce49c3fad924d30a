#include "ngs/ops/image/connected_components.h"

namespace ngs {

ConnectedComponents connected_components(MaskPlane mask) {
  ConnectedComponents out;
  out.component.assign(std::size_t(mask.pixels()), -1);
  std::vector<std::int64_t> open;
  for (std::int64_t first = 0; first < mask.pixels(); ++first) {
    if (mask.data[first] == 0 || out.component[std::size_t(first)] >= 0) continue;
    const auto number = std::int32_t(out.size.size());
    out.size.push_back(0);
    const auto visit = [&](std::int64_t p) {
      if (mask.data[p] == 0 || out.component[std::size_t(p)] >= 0) return;
      out.component[std::size_t(p)] = number;
      ++out.size.back();
      open.push_back(p);
    };
    visit(first);
    while (!open.empty()) {
      const std::int64_t p = open.back(), x = p % mask.width_px;
      open.pop_back();
      if (x > 0) visit(p - 1);
      if (x + 1 < mask.width_px) visit(p + 1);
      if (p >= mask.width_px) visit(p - mask.width_px);
      if (p + mask.width_px < mask.pixels()) visit(p + mask.width_px);
    }
  }
  return out;
}

}  // namespace ngs
