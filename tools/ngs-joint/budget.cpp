#include "budget.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ngs/stages/photo_refit.h"
#include "ngs/stages/render_stage.h"

namespace ngs::joint {
namespace {

constexpr double kLeastClosing_s = 0.1;   // to write the result; reading the model may tell of more
constexpr double kMeasuringShare = 0.02;  // of the budget
constexpr double kCaution = 1.25;         // on what cannot be stopped
constexpr int kDraftRefitVisits = 3;

/// Of a view.
double refit_renders(int visits, int shrink) { return kRefitVisitCost.renders * visits / double(shrink) / double(shrink); }

}  // namespace

double Budget::left_s() const {
  return seconds_ ? *seconds_ - closing_s_ - elapsed_s() : std::numeric_limits<double>::infinity();
}

void Budget::measure(const Exec& exec, const MethodInput& input, double reading_s) {
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

bool Budget::has_room_for(const StageCost& cost, std::size_t views) const {
  return !given() || kCaution * foreseen_s(cost.renders * double(views)) <= cost.share * left_s();
}

void Budget::took(std::string_view name, double renders, double seconds) {
  if (!given()) return;
  const double foreseen = renders * render_s_;
  laps_.push_back({{"stage", name}, {"foreseen_s", foreseen_s(renders)}, {"took_s", seconds}});
  pace_.add(foreseen, seconds);
}

int Budget::plan_refit(bool draft, int shrink, std::size_t views) {
  const int most = draft ? kDraftRefitVisits : RefitOptions{}.visits;
  const double visit_s = foreseen_s(refit_renders(1, shrink) * double(views));
  if (!given()) return most;
  const VisitsPlan plan = plan_visits(visit_s, kRefitVisitCost.share * left_s(), kCaution, most);
  cut_ |= plan.cut;
  return plan.visits;
}

Budget::Lap Budget::lap_refit(int visits, int shrink, std::size_t views) {
  return {*this, kRefitVisitCost.name, refit_renders(visits, shrink) * double(views)};
}

RoundsCost Budget::rounds_cost(const JointOptions& joint, const EdgeOptions& edge, const Scene& scene,
                               std::size_t training_views) const {
  const JointEffects effects = parse_effects(joint.effect);
  const std::size_t views = edge.views == EdgeViews::kAll ? scene.views.size() : training_views;
  const double n = double(views);
  const int visits = edge_visits(edge, joint.quality, views);
  RoundsCost rounds{.walk_s = foreseen_s(kWalkRenders * n),
                    .visit_s = foreseen_s(kEdgeStepRenders * n),
                    .early_share = early_round_share(effects, visits),
                    .check_s = foreseen_s(kCheckCost.renders * double(training_views)),
                    .rounds = 0,
                    .visits = visits};
  if (effects.edges && rounds.visits > 0) rounds.rounds = effects.second_round ? edge_rounds(edge, joint.quality, true) : 1;
  if (rounds.rounds > 0 && may_try_pictures(edge, scene)) ++rounds.rounds;
  return rounds;
}

TimePlan Budget::plan(const JointOptions& joint, const EdgeOptions& edge, const Scene& scene,
                      std::size_t training_views) const {
  const JointEffects effects = parse_effects(joint.effect);
  const double n = double(training_views);
  StepsCost steps{.visit_s = foreseen_s(kStepRenders * n), .field_visit_s = 0, .visits = 0};
  if (effects.joint)
    steps.visits = joint.steps > 0 ? int(std::ceil(double(joint.steps) / n)) : visits_of(joint.quality, effects);
  if (effects.nerf) steps.field_visit_s = foreseen_s(kFieldStepRenders * n);
  return plan_time(left_s(), steps, rounds_cost(joint, edge, scene, training_views));
}

TimePlan Budget::plan_rounds(const JointOptions& joint, const EdgeOptions& edge, const Scene& scene,
                             std::size_t training_views, std::optional<double> first_walk_s) const {
  RoundsCost rounds = rounds_cost(joint, edge, scene, training_views);
  rounds.walk_s = first_walk_s.value_or(rounds.walk_s);
  return plan_time(left_s() + first_walk_s.value_or(0), {}, rounds);
}

Json Budget::json() const {
  return {{"seconds", seconds_.value_or(0)},
          {"render_s", render_s_},
          {"pace", pace_.factor()},
          {"cut", cut_},
          {"stages", laps_}};
}

}  // namespace ngs::joint
