#include "ngs/scene/packed_masks.h"

#include <algorithm>
#include <bit>

namespace ngs {

PackedMasks::PackedMasks(ViewMasks masks) : rest_(std::move(masks)) {
  const auto bits = [](float v) { return std::bit_cast<std::uint32_t>(v); };
  for (const std::vector<float>& plane : rest_.target) {
    std::vector<Run>& runs = target_.emplace_back();
    for (std::size_t i = 0; i < plane.size(); ++i)
      if (i > 0 && bits(plane[i]) == bits(plane[i - 1]))
        runs.back().end = i + 1;
      else
        runs.push_back({plane[i], i + 1});
    runs.shrink_to_fit();
  }
  rest_.target.clear();
  rest_.target.shrink_to_fit();
}

ViewMasks PackedMasks::unpacked() const {
  ViewMasks masks = rest_;
  for (const std::vector<Run>& runs : target_) {
    std::vector<float>& plane = masks.target.emplace_back(runs.empty() ? 0 : runs.back().end);
    auto at = plane.begin();
    for (const Run& run : runs) at = std::fill_n(at, run.end - std::size_t(at - plane.begin()), run.value);
  }
  return masks;
}

}  // namespace ngs
