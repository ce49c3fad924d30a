// Treats labelled Gaussians that are disconnected from the object as unseen.                    paper.md §5.13
#include <algorithm>

#include "ngs/cut/passes/components/components.h"
#include "ngs/cut/passes/pass.h"
#include "ngs/cut/passes/pass_list.h"

namespace ngs {
namespace {

class ComponentsPass : public Pass {
 public:
  PassStage stage() const override { return PassStage::kRepair; }
  std::vector<Effect> effects() const override;
  void run(PassRun& run) override;
  void edit_solution(PassRun& run) override;
};

}  // namespace

std::vector<Effect> ComponentsPass::effects() const {
  return {
      {.name = "components",
       .help = "unlabel pieces that are disconnected from the object",
       .saves = "linking of labelled Gaussians",
       .heuristic = {"labelled Gaussians that are disconnected from the object", 0, "one is enough: it may be large",
                     [](SceneProbe& probe) { return double(count_disconnected(probe.exec(), probe.problem())); }}}};
}

void ComponentsPass::edit_solution(PassRun& run) {
  const bool labels_were_trained = run.trainer != nullptr;
  const bool is_switched_off = std::ranges::none_of(run.decisions.all(), [](const Decision& decision) {
    return decision.effect->name == "components" && (decision.on || decision.measured);
  });
  if (!labels_were_trained || is_switched_off) return;
  run.report["components"]["withdrawn"] = restore_disconnected_labels(run.exec, *run.problem, *run.solution);
}

void ComponentsPass::run(PassRun& run) {
  Problem& problem = *run.problem;
  ComponentFinding finding = find_disconnected(run.exec, problem, problem.labels.release());
  problem.labels = std::move(finding.labels);
  run.report["components"] = {{"found", finding.count}};
  if (finding.count == 0) return;
  problem.frozen.resize(finding.disconnected.size());
  for (std::size_t i = 0; i < finding.disconnected.size(); ++i) problem.frozen[i] |= finding.disconnected[i];
  run.field_matches_model = false;
  run.log(std::to_string(finding.count) + " labelled Gaussians are disconnected from the object: treated as unseen");
}

std::unique_ptr<Pass> make_components_pass() { return std::make_unique<ComponentsPass>(); }

}  // namespace ngs
