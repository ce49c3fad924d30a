#include "ngs/stages/time_plan.h"

#include <algorithm>

namespace ngs {

TimePlan plan_time(double left_s, const StepsCost& steps, const RoundsCost& edges) {
  const double all_steps_s = steps.visits * (steps.visit_s + steps.field_visit_s);
  if (left_s >= all_steps_s + edges.all_s())
    return {.steps = steps.visits > 0, .steps_s = left_s - edges.all_s(), .edge_rounds = edges.rounds};
  TimePlan plan{.field = false, .cut = true};
  const double first_s = std::min(steps.visits, 1) * steps.visit_s, rest_s = left_s - first_s - edges.check_s;
  const auto last_visits = [&](int rounds) { return (rest_s - edges.before_last_s(rounds)) / edges.visit_s; };
  int rounds = edges.rounds;
  while (rounds > 1 && last_visits(rounds) < edges.least_last() * edges.visits) --rounds;
  if (rounds > 0 && last_visits(rounds) < std::min(kLeastEdgeVisits, edges.visits)) rounds = 0;
  plan.edge_rounds = rounds;
  const double spare_s = rounds > 0 ? std::max(first_s, left_s - edges.all_s(rounds)) : std::max(0.0, left_s);
  plan.steps = steps.visits > 0 && spare_s >= kLeastVisit * steps.visit_s;
  plan.steps_s = plan.steps ? spare_s : 0;
  return plan;
}

VisitsPlan plan_visits(double visit_s, double room_s, double caution, int most) {
  if (caution * visit_s * most <= room_s) return {most, false};
  const int visits = int(std::clamp(room_s / visit_s, 1.0, double(most)));
  return {visits, visits < most};
}

}  // namespace ngs
