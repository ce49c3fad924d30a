#include "ngs/passes/time/time_plan.h"

#include <algorithm>

namespace ngs {

TimePlan plan_time(double left_s, const StepsCost& steps, const IterationsCost& edges) {
  const double all_steps_s = steps.epochs * (steps.epoch_s + steps.field_epoch_s);
  if (left_s >= all_steps_s + edges.all_s())
    return {.steps = steps.epochs > 0, .steps_s = left_s - edges.all_s(), .contour_iterations = edges.iterations};
  TimePlan plan{.field = false, .cut = true};
  const double first_s = std::min(steps.epochs, 1) * steps.epoch_s, rest_s = left_s - first_s - edges.check_s;
  const auto last_epochs = [&](int iterations) { return (rest_s - edges.before_last_s(iterations)) / edges.epoch_s; };
  int iterations = edges.iterations;
  while (iterations > 1 && last_epochs(iterations) < edges.least_last() * edges.epochs) --iterations;
  if (iterations > 0 && last_epochs(iterations) < std::min(kLeastContourEpochs, edges.epochs)) iterations = 0;
  plan.contour_iterations = iterations;
  const double spare_s = iterations > 0 ? std::max(first_s, left_s - edges.all_s(iterations)) : std::max(0.0, left_s);
  plan.steps = steps.epochs > 0 && spare_s >= kLeastEpoch * steps.epoch_s;
  plan.steps_s = plan.steps ? spare_s : 0;
  return plan;
}

EpochsPlan plan_epochs(double epoch_s, double available_s, double caution, int most) {
  if (caution * epoch_s * most <= available_s) return {most, false};
  const int epochs = int(std::clamp(available_s / epoch_s, 1.0, double(most)));
  return {epochs, epochs < most};
}

}  // namespace ngs
