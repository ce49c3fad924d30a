#include "ngs/cut/passes/components/components.h"

#include <algorithm>
#include <optional>
#include <span>
#include <unordered_set>

#include "ngs/backend/for_each.h"
#include "ngs/cut/evidence/method_labels.h"
#include "ngs/cut/passes/pass.h"
#include "ngs/cut/passes/pass_list.h"
#include "ngs/math/cell_grid.h"

namespace ngs {
namespace {

constexpr CoreOptions kCore{.seen = 0.5, .margin = 0.5};
constexpr double kLinks = 0.5;                      // share from which a Gaussian links others to the core
constexpr double kCandidate = kMinForegroundShare;  // share from which a Gaussian is tested

/// The grid cells that are connected to an object's core.
class LinkedCells {
 public:
  /// Nullopt: there is no core, or it has no extent.
  static std::optional<LinkedCells> of(const Exec& exec, const GaussianCloud& cloud, const LabelColumns& object) {
    const ObjectCore core = core_of(kCore, cloud, std::span(&object, 1));
    const double margin = core.count > 1 ? core_margin(exec, kCore, cloud, core) : 0;
    if (!(margin > 0)) return std::nullopt;
    LinkedCells cells({{core.centre[0], core.centre[1], core.centre[2]}, margin}, core.min_views);
    cells.link(cloud, object, core);
    return cells;
  }

  /// Minimum number of views of the core's Gaussians.
  double min_views() const { return min_views_; }
  bool has_near(const float* position) const {
    bool near = false;
    CellGrid::for_neighbours(grid_.of(position), [&](std::uint64_t cell) { near |= linked_.contains(cell); });
    return near;
  }

 private:
  LinkedCells(CellGrid grid, double min_views) : grid_(grid), min_views_(min_views) {}

  void link(const GaussianCloud& cloud, const LabelColumns& object, const ObjectCore& core) {
    std::unordered_set<std::uint64_t> labelled;
    std::vector<std::uint64_t> open;
    for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i) {
      if (!cloud.usable[i] || !(double(object.prob[i]) > kLinks)) continue;
      const std::uint64_t cell = grid_.of(&cloud.position[3 * i]);
      labelled.insert(cell);
      if (core.member[i] && linked_.insert(cell).second) open.push_back(cell);
    }
    while (!open.empty()) {
      const std::uint64_t cell = open.back();
      open.pop_back();
      CellGrid::for_neighbours(cell, [&](std::uint64_t next) {
        if (labelled.contains(next) && linked_.insert(next).second) open.push_back(next);
      });
    }
  }

  CellGrid grid_;
  double min_views_;
  std::unordered_set<std::uint64_t> linked_;
};

using FarRows = std::vector<std::size_t>;

/// Rows with object evidence that are not linked to the core.
FarRows far_from_core(const Exec& exec, const Problem& input, const LabelColumns& object) {
  const GaussianCloud& cloud = input.cloud;
  FarRows far;
  const std::optional<LinkedCells> cells = LinkedCells::of(exec, cloud, object);
  for (std::size_t i = 0; cells && i < std::size_t(cloud.size()); ++i) {
    if (!cloud.usable[i] || !(double(object.prob[i]) > kCandidate) || is_fixed(input, i)) continue;
    if (double(object.views[i]) < cells->min_views() && !cells->has_near(&cloud.position[3 * i])) far.push_back(i);
  }
  return far;
}

/// The same for each object. One object uses all threads; several objects use one thread each.
std::vector<FarRows> far_from_cores(const Exec& exec, const Problem& input, const std::vector<LabelColumns>& objects) {
  std::vector<FarRows> far(objects.size());
  const Exec serial;
  if (objects.size() == 1)
    far[0] = far_from_core(exec, input, objects[0]);
  else
    for_each_task(exec, std::ssize(objects), [&](std::int64_t task) {
      const auto k = std::size_t(task);
      far[k] = far_from_core(serial, input, objects[k]);
    });
  return far;
}

/// Treats labelled Gaussians that are disconnected from the object as unseen.                    paper.md §5.13
class ComponentsPass : public Pass {
 public:
  ComponentsPass() : Pass({PassStage::kRepair}) {}
  std::vector<Effect> effects() const override {
    return {
        {.name = "components",
         .help = "unlabel pieces that are disconnected from the object",
         .saves = "linking of labelled Gaussians",
         .heuristic = {"labelled Gaussians that are disconnected from the object", 0, "one is enough: it may be large",
                       [](SceneProbe& probe) { return double(count_disconnected(probe.exec(), probe.problem())); }}}};
  }
  void run(PassRun& run) override {
    Problem& problem = *run.problem;
    ComponentFinding finding = find_disconnected(run.exec, problem, problem.labels.release());
    problem.labels = std::move(finding.labels);
    run.report["components"] = {{"found", finding.count}};
    if (finding.count == 0) return;
    problem.frozen.resize(finding.disconnected.size());
    for (std::size_t i = 0; i < finding.disconnected.size(); ++i) problem.frozen[i] |= finding.disconnected[i];
    run.log(std::to_string(finding.count) + " labelled Gaussians are disconnected from the object: treated as unseen");
  }
  void finish(PassRun& run) override {
    const bool is_switched_off = std::ranges::none_of(run.decisions.all(), [](const Decision& decision) {
      return decision.effect->name == "components" && (decision.on || decision.measured);
    });
    if (!trains(run) || is_switched_off) return;
    run.report["components"]["withdrawn"] = restore_disconnected_labels(run.exec, *run.problem, *run.solution);
  }
};

}  // namespace

std::int64_t count_disconnected(const Exec& exec, const Problem& input) {
  std::int64_t count = 0;
  for (const FarRows& far : far_from_cores(exec, input, input.labels)) count += std::ssize(far);
  return count;
}

ComponentFinding find_disconnected(const Exec& exec, const Problem& input, std::vector<LabelColumns> labels) {
  ComponentFinding finding{std::move(labels), std::vector<std::uint8_t>(std::size_t(input.cloud.size()), 0)};
  const std::vector<FarRows> far = far_from_cores(exec, input, finding.labels);
  for (std::size_t k = 0; k < far.size(); ++k) {
    LabelColumns& object = finding.labels[k];
    for (const std::size_t i : far[k]) {
      ++finding.count;
      finding.disconnected[i] = 1;
      object.label[i] = object.prob[i] = object.variance[i] = object.views[i] = object.boundary[i] = 0;
    }
  }
  for (const LabelColumns& object : finding.labels)
    for (std::size_t i = 0; i < finding.disconnected.size(); ++i)
      if (double(object.prob[i]) > kCandidate) finding.disconnected[i] = 0;
  return finding;
}

std::int64_t restore_disconnected_labels(const Exec& exec, const Problem& input, Solution& solution) {
  const GaussianCloud& cloud = *solution.cloud;
  std::int64_t count = 0;
  for (std::size_t k = 0; k < solution.labels.size(); ++k) {
    LabelColumns& object = solution.labels[k];
    const LabelColumns& given = input.labels[k];
    std::optional<LinkedCells> cells;  // computed once a newly labelled row is found
    bool searched = false;
    for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i) {
      const std::size_t source = solution.source_row.empty() ? i : std::size_t(solution.source_row[i]);
      const bool newly_labelled = double(object.prob[i]) > kLinks && !(double(given.prob[source]) > kLinks);
      if (!newly_labelled || !cloud.usable[i] || is_fixed(input, source)) continue;
      if (!searched) {
        cells = LinkedCells::of(exec, cloud, object);
        searched = true;
      }
      if (!cells || cells->has_near(&cloud.position[3 * i])) continue;
      object.label[i] = given.label[source];
      object.prob[i] = given.prob[source];
      ++count;
    }
  }
  return count;
}

std::unique_ptr<Pass> make_components_pass() { return std::make_unique<ComponentsPass>(); }

}  // namespace ngs
