#include "ngs/passes/components/components.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <unordered_set>

#include "ngs/stages/boundary/method_labels.h"

namespace ngs {
namespace {

/// Cells of a regular grid about the core, as keys: 21 bits per axis, and what lies beyond them in the outermost.
class Cells {
 public:
  Cells(const ObjectCore& core, double side) : core_(core), side_(side) {}

  std::uint64_t of(const float* position) const {
    std::int64_t c[3];
    for (int a = 0; a < 3; ++a)
      c[a] = kMiddle + std::int64_t(std::clamp(std::floor((double(position[a]) - core_.centre[a]) / side_),
                                               -double(kMiddle) + 1, double(kMiddle) - 1));
    return key(c[0], c[1], c[2]);
  }
  /// Calls visit(cell) for the cell and the 26 about it.
  template <class Visit>
  static void for_neighbours(std::uint64_t cell, const Visit& visit) {
    const auto axis = [cell](int a) { return std::int64_t(cell >> (21 * a) & (2 * kMiddle - 1)); };
    for (std::int64_t z = axis(2) - 1; z <= axis(2) + 1; ++z)
      for (std::int64_t y = axis(1) - 1; y <= axis(1) + 1; ++y)
        for (std::int64_t x = axis(0) - 1; x <= axis(0) + 1; ++x) visit(key(x, y, z));
  }

 private:
  static constexpr std::int64_t kMiddle = std::int64_t(1) << 20;
  static std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) {
    return std::uint64_t(x) | std::uint64_t(y) << 21 | std::uint64_t(z) << 42;
  }
  const ObjectCore& core_;
  double side_;
};

/// 1: claimed, and not linked with the core.
std::vector<std::uint8_t> far_from_core(const Exec& exec, const ComponentOptions& options, const Problem& input,
                                        const LabelColumns& object) {
  const GaussianCloud& cloud = input.cloud;
  const auto n = std::size_t(cloud.size());
  std::vector<std::uint8_t> far(n, 0);
  const ObjectCore core = core_of(options.core, cloud, std::span(&object, 1));
  const double margin = core.count > 1 ? core_margin(exec, options.core, cloud, core) : 0;
  if (!(margin > 0)) return far;
  const Cells cells(core, margin);
  std::unordered_set<std::uint64_t> labelled, linked;
  std::vector<std::uint64_t> open;
  for (std::size_t i = 0; i < n; ++i) {
    if (!cloud.usable[i] || !(double(object.prob[i]) > options.labelled)) continue;
    const std::uint64_t cell = cells.of(&cloud.position[3 * i]);
    labelled.insert(cell);
    if (core.member[i] && linked.insert(cell).second) open.push_back(cell);
  }
  while (!open.empty()) {
    const std::uint64_t cell = open.back();
    open.pop_back();
    Cells::for_neighbours(cell, [&](std::uint64_t next) {
      if (labelled.contains(next) && linked.insert(next).second) open.push_back(next);
    });
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (!cloud.usable[i] || !(double(object.prob[i]) > options.claimed) || is_fixed(input, i)) continue;
    if (double(object.views[i]) >= core.least_views) continue;
    bool near = false;
    Cells::for_neighbours(cells.of(&cloud.position[3 * i]), [&](std::uint64_t cell) { near |= linked.contains(cell); });
    far[i] = !near;
  }
  return far;
}

}  // namespace

ComponentFinding find_disconnected(const Exec& exec, const ComponentOptions& options, const Problem& input) {
  ComponentFinding finding{input.labels, std::vector<std::uint8_t>(std::size_t(input.cloud.size()), 0)};
  for (LabelColumns& object : finding.labels) {
    const std::vector<std::uint8_t> far = far_from_core(exec, options, input, object);
    for (std::size_t i = 0; i < far.size(); ++i) {
      if (!far[i]) continue;
      ++finding.count, finding.disconnected[i] = 1;
      object.label[i] = object.prob[i] = object.variance[i] = object.views[i] = object.boundary[i] = 0;
    }
  }
  for (const LabelColumns& object : finding.labels)
    for (std::size_t i = 0; i < finding.disconnected.size(); ++i)
      if (double(object.prob[i]) > options.claimed) finding.disconnected[i] = 0;
  return finding;
}

}  // namespace ngs
