#include "ngs/passes/components/components.h"

#include <span>
#include <unordered_set>

#include "ngs/math/cell_grid.h"
#include "ngs/stages/boundary/method_labels.h"

namespace ngs {
namespace {

/// 1: claimed, and not linked with the core.
std::vector<std::uint8_t> far_from_core(const Exec& exec, const ComponentOptions& options, const Problem& input,
                                        const LabelColumns& object) {
  const GaussianCloud& cloud = input.cloud;
  const auto n = std::size_t(cloud.size());
  std::vector<std::uint8_t> far(n, 0);
  const ObjectCore core = core_of(options.core, cloud, std::span(&object, 1));
  const double margin = core.count > 1 ? core_margin(exec, options.core, cloud, core) : 0;
  if (!(margin > 0)) return far;
  const CellGrid cells({core.centre[0], core.centre[1], core.centre[2]}, margin);
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
    CellGrid::for_neighbours(cell, [&](std::uint64_t next) {
      if (labelled.contains(next) && linked.insert(next).second) open.push_back(next);
    });
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (!cloud.usable[i] || !(double(object.prob[i]) > options.claimed) || is_fixed(input, i)) continue;
    if (double(object.views[i]) >= core.least_views) continue;
    bool near = false;
    CellGrid::for_neighbours(cells.of(&cloud.position[3 * i]),
                             [&](std::uint64_t cell) { near |= linked.contains(cell); });
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
