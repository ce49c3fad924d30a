#include "budget.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ngs/stages/fit/photo_refit.h"
#include "ngs/stages/render/render_stage.h"

namespace ngs::joint {
namespace {

constexpr double kLeastClosing_s = 0.1;   // to write the result; reading the model may tell of more
constexpr double kMeasuringShare = 0.02;  // of the budget
constexpr double kCaution = 1.25;         // on what cannot be stopped
constexpr int kDraftRefitEpochs = 3;

/// Of a view.
double refit_renders(int epochs, int shrink) { return kRefitEpochCost.renders * epochs / double(shrink) / double(shrink); }

}  // namespace

double Budget::left_s() const {
  return seconds_ ? *seconds_ - closing_s_ - elapsed_s() : std::numeric_limits<double>::infinity();
}

void Budget::measure(const Exec& exec, const Problem& input, double reading_s) {
  if (!given() || input.views.empty()) return;
  closing_s_ = kLeastClosing_s + 2 * reading_s;
  const Camera& camera = input.scene.views[input.views.front()].camera;
  render_s_ = std::numeric_limits<double>::infinity();
  const double began_s = wall_seconds(), most_s = kMeasuringShare * *seconds_;
  for (int again = 0; again < 5 && wall_seconds() - began_s <= most_s; ++again) {  // best: least disturbed
    const double before = wall_seconds();
    render(exec, input.cloud, camera, input.splat, {});
    render_s_ = std::min(render_s_, wall_seconds() - before);
  }
}

bool Budget::fits(const StageCost& cost, std::size_t views) const {
  return !given() || kCaution * foreseen_s(cost.renders * double(views)) <= cost.share * left_s();
}

void Budget::took(std::string_view name, double renders, double seconds) {
  if (!given()) return;
  const double foreseen = renders * render_s_;
  laps_.push_back({{"stage", name}, {"foreseen_s", foreseen_s(renders)}, {"took_s", seconds}});
  pace_.add(foreseen, seconds);
}

int Budget::plan_refit(bool draft, int shrink, std::size_t views) {
  const int most = draft ? kDraftRefitEpochs : RefitOptions{}.epochs;
  const double epoch_s = foreseen_s(refit_renders(1, shrink) * double(views));
  if (!given()) return most;
  const EpochsPlan plan = plan_epochs(epoch_s, kRefitEpochCost.share * left_s(), kCaution, most);
  cut_ |= plan.cut;
  return plan.epochs;
}

Budget::Lap Budget::lap_refit(int epochs, int shrink, std::size_t views) {
  return {*this, kRefitEpochCost.name, refit_renders(epochs, shrink) * double(views)};
}

IterationsCost Budget::iterations_cost(const JointOptions& joint, const ContourOptions& edge, const Scene& scene,
                               std::size_t training_views) const {
  const JointEffects effects = parse_effects(joint.effect);
  const std::size_t views = edge.views == ContourViews::kAll ? scene.views.size() : training_views;
  const double n = double(views);
  const int epochs = contour_epochs(edge, joint.quality, views);
  IterationsCost iterations{.refine_s = foreseen_s(kRefineRenders * n),
                    .epoch_s = foreseen_s(kContourStepRenders * n),
                    .early_share = early_iteration_share(effects, epochs),
                    .check_s = foreseen_s(kCheckCost.renders * double(training_views)),
                    .iterations = 0,
                    .epochs = epochs};
  if (effects.edges && iterations.epochs > 0) iterations.iterations = effects.contour_iterations_on ? contour_iterations(edge, joint.quality, true) : 1;
  if (iterations.iterations > 0 && may_try_pictures(edge, scene)) ++iterations.iterations;
  return iterations;
}

TimePlan Budget::plan(const JointOptions& joint, const ContourOptions& edge, const Scene& scene,
                      std::size_t training_views) const {
  const JointEffects effects = parse_effects(joint.effect);
  const double n = double(training_views);
  StepsCost steps{.epoch_s = foreseen_s(kStepRenders * n), .field_epoch_s = 0, .epochs = 0};
  if (effects.joint)
    steps.epochs = joint.steps > 0 ? int(std::ceil(double(joint.steps) / n)) : epochs_of(joint.quality, effects);
  if (effects.nerf) steps.field_epoch_s = foreseen_s(kFieldStepRenders * n);
  return plan_time(left_s(), steps, iterations_cost(joint, edge, scene, training_views));
}

TimePlan Budget::plan_iterations(const JointOptions& joint, const ContourOptions& edge, const Scene& scene,
                             std::size_t training_views, std::optional<double> first_refine_s) const {
  IterationsCost iterations = iterations_cost(joint, edge, scene, training_views);
  iterations.refine_s = first_refine_s.value_or(iterations.refine_s);
  return plan_time(left_s() + first_refine_s.value_or(0), {}, iterations);
}

Json Budget::json() const {
  return {{"seconds", seconds_.value_or(0)},
          {"render_s", render_s_},
          {"pace", pace_.factor()},
          {"cut", cut_},
          {"stages", laps_}};
}

}  // namespace ngs::joint
