#include "ngs/scene/rle_masks.h"

#include <bit>
#include <limits>

namespace ngs {
namespace {

/// Whether pixel i > 0 differs in bits from pixel i - 1.
bool begins_run(const std::vector<float>& plane, std::size_t i) {
  return std::bit_cast<std::uint32_t>(plane[i]) != std::bit_cast<std::uint32_t>(plane[i - 1]);
}

}  // namespace

RleMasks::Plane RleMasks::packed(std::vector<float> plane) {
  std::size_t count = plane.empty() ? 0 : 1;
  for (std::size_t i = 1; i < plane.size(); ++i) count += begins_run(plane, i);
  Plane out;
  if (count * sizeof(Run) > plane.size() * sizeof(float) || plane.size() > std::numeric_limits<std::uint32_t>::max()) {
    out.values = std::move(plane);
    return out;
  }
  out.runs.reserve(count);
  for (std::size_t i = 1; out.runs.size() + 1 < count; ++i)
    if (begins_run(plane, i)) out.runs.push_back({plane[i - 1], std::uint32_t(i)});
  if (count > 0) out.runs.push_back({plane.back(), std::uint32_t(plane.size())});
  return out;
}

RleMasks::RleMasks(ViewMasks masks) : rest_(std::move(masks)) {
  for (std::vector<float>& plane : rest_.target) target_.push_back(packed(std::move(plane)));
  rest_.target.clear();
  rest_.target.shrink_to_fit();
}

void RleMasks::unpack(ViewMasks& out) const {
  out.width_px = rest_.width_px;
  out.height_px = rest_.height_px;
  out.available = rest_.available;
  out.known = rest_.known;
  out.target.resize(target_.size());
  for (std::size_t k = 0; k < target_.size(); ++k) {
    const Plane& from = target_[k];
    std::vector<float>& plane = out.target[k];
    plane = from.values;
    if (!from.runs.empty()) plane.reserve(from.runs.back().end);
    for (const Run& run : from.runs) plane.insert(plane.end(), run.end - plane.size(), run.value);
  }
}

ViewMasks RleMasks::unpacked() const {
  ViewMasks masks;
  unpack(masks);
  return masks;
}

std::size_t RleMasks::bytes() const {
  std::size_t bytes = rest_.known.size();
  for (const Plane& plane : target_) bytes += plane.runs.size() * sizeof(Run) + plane.values.size() * sizeof(float);
  return bytes;
}

}  // namespace ngs
