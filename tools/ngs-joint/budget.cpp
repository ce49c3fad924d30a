#include "budget.h"

#include <algorithm>
#include <limits>

#include "ngs/stages/render_stage.h"

namespace ngs::joint {

double Budget::left_s() const {
  return seconds_ ? *seconds_ - kClosing_s - elapsed_s() : std::numeric_limits<double>::infinity();
}

void Budget::measure(const Exec& exec, const MethodInput& input) {
  if (!given() || input.views.empty()) return;
  const Camera& camera = input.scene.views[input.views.front()].camera;
  render_s_ = std::numeric_limits<double>::infinity();
  for (int again = 0; again < 5; ++again) {  // the best is least disturbed
    const double before = wall_seconds();
    render(exec, input.cloud, camera, input.splat, {});
    render_s_ = std::min(render_s_, wall_seconds() - before);
  }
}

bool Budget::has_room_for(const StageCost& cost, std::size_t views) const {
  return !given() || cost.per_view * double(views) * render_s_ <= cost.share * left_s();
}

std::int64_t Budget::steps_that_fit(const JointOptions& joint, std::size_t views, bool edges_follow) {
  const std::int64_t wanted = visits_of(joint.quality) * std::int64_t(views);
  if (!given()) return wanted;
  const double room_s = (edges_follow ? kJointStepCost.share : 1.0) * left_s();
  const auto fit = std::int64_t(std::max(1.0, room_s / (kJointStepCost.per_view * render_s_)));
  cut_ |= fit < wanted;
  return std::min(fit, wanted);
}

Budget::Rounds planned_rounds(double left_s, double round_s, double visit_s, int rounds, int visits) {
  const auto visits_in = [&](int n) { return int((left_s - n * round_s) / (n * visit_s)); };
  int n = rounds;
  while (n > 1 && 2 * visits_in(n) < visits) --n;
  const int fit = std::min(visits, visits_in(n));
  if (n < 1 || fit < 1) return {0, 0, true};
  return {n, fit, n < rounds || fit < visits};
}

Budget::Rounds Budget::plan_edges(const EdgeOptions& edge, Quality quality, std::size_t views) const {
  const int visits = edge_visits(edge, quality);
  if (!given() || visits == 0) return {edge.rounds, visits, false};
  const double unit_s = render_s_ * double(views);
  return planned_rounds(left_s(), (kWalkRenders + kRoundRenders) * unit_s, kEdgeStepRenders * unit_s,
                        edge.rounds, visits);
}

}  // namespace ngs::joint
