// Removes labels of Gaussians that are only visible through the object.                          paper.md §5.17
#include <cmath>

#include "ngs/cut/passes/bleed_through/bleed_through.h"
#include "ngs/cut/passes/pass.h"
#include "ngs/cut/passes/pass_list.h"
#include "ngs/problem/scene_measures.h"

namespace ngs {
namespace {

class BleedThroughPass : public Pass {
 public:
  PassStage stage() const override { return PassStage::kOptimise; }
  std::vector<Effect> effects() const override;
  std::vector<FixedDecision> fixed_decisions(const TrainingOptions&) const override;
  void run(PassRun& run) override;
};

}  // namespace
std::vector<Effect> BleedThroughPass::effects() const {
  return {{.name = "bleed-through",
           .help = "unlabel Gaussians that are only visible through the object",
           .saves = "evidence weighted by visibility, and its test against the masks",
           .heuristic = {
               "loss of agreement with the masks by contour refinement, normal score (0: the photos show edges that "
               "the model does not, or the masks err to one side)",
               kSignificant, "above it the masks are accurate on average, so labels can be tested against them",
               [](SceneProbe& probe) { return 0 - probe.edge_gain(); }}}};
}

std::vector<FixedDecision> BleedThroughPass::fixed_decisions(const TrainingOptions& training) const {
  if (preset_of(training.joint.quality).bleed_through) return {};
  return {{"bleed-through", false, "--quality draft"}};
}

void BleedThroughPass::run(PassRun& run) {
  const auto timed = run.monitor.scope("bleed-through");
  Problem& problem = *run.problem;
  BleedThrough finding = without_bleed_through(run.exec, problem, problem.labels);
  if (run.monitor.stop_requested()) return;
  problem.labels = std::move(finding.labels);
  Json objects = Json::array();
  std::int64_t count = 0;
  for (std::size_t k = 0; k < finding.objects.size(); ++k) {
    const BleedThrough::OfObject& of = finding.objects[k];
    objects.push_back({{"object", problem.scene.objects[k].name},
                       {"found", of.found},
                       {"gain", std::isfinite(of.gain) ? Json(of.gain) : Json()},
                       {"taken", of.taken}});
    if (of.taken) count += of.found;
  }
  run.report["bleed_through"] = {{"gaussians", count}, {"objects", std::move(objects)}};
  if (count > 0) run.log(std::to_string(count) + " Gaussians are only visible through the object: label removed");
}

std::unique_ptr<Pass> make_bleed_through_pass() { return std::make_unique<BleedThroughPass>(); }

}  // namespace ngs
