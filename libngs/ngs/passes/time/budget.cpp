#include "ngs/passes/time/budget.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ngs/core/error.h"
#include "ngs/core/parse_number.h"
#include "ngs/problem/view_list.h"
#include "ngs/scene/shrink.h"
#include "ngs/stages/render/render_stage.h"

namespace ngs {
namespace {

constexpr double kLeastClosing_s = 0.1;   // to write the result; reading the model may tell of more
constexpr double kMeasuringShare = 0.02;  // of the budget
constexpr std::size_t kMeasured = 5;      // renders
constexpr double kCaution = 1.25;         // on what cannot be stopped

/// Of a picture with as many pixels as the views have in the mean; the best of some times.
double halving_s(const Problem& problem) {
  double pixels = 0;
  for (const std::size_t view : problem.views) {
    const Camera& camera = problem.scene.views[view].camera;
    pixels += double(camera.width_px) * double(camera.height_px) / double(problem.views.size());
  }
  const int side_px = std::max(2, int(std::sqrt(pixels)));
  const ImageF picture(side_px, side_px, 3, 0.5f);
  double best_s = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < kMeasured; ++i) {
    const double began_s = wall_seconds();
    shrunk(picture, 2);
    best_s = std::min(best_s, wall_seconds() - began_s);
  }
  return best_s;
}

}  // namespace

double Budget::left_s() const {
  return seconds_ ? *seconds_ - closing_s_ - elapsed_s() : std::numeric_limits<double>::infinity();
}

void Budget::measure(const Exec& exec, const Problem& problem, double reading_s) {
  if (!given() || problem.views.empty()) return;
  closing_s_ = kLeastClosing_s + 1.5 * reading_s;
  halving_s_ = halving_s(problem);
  const double began_s = wall_seconds(), most_s = kMeasuringShare * *seconds_;
  const auto rendering_s = [&](std::size_t view) {
    const double before_s = wall_seconds();
    render(exec, problem.cloud, problem.scene.views[view].camera, problem.splat, {});
    return wall_seconds() - before_s;
  };
  render_s_ = rendering_s(problem.views.front());
  double sum_s = 0;  // windows differ: of some views; else the best of one, the least disturbed
  int count = 0;
  for (const std::size_t view : spread_views(problem.views, kMeasured)) {
    if (wall_seconds() - began_s > most_s) break;
    const double taken_s = rendering_s(problem.window_share.empty() ? problem.views.front() : view);
    render_s_ = std::min(render_s_, taken_s), sum_s += taken_s, ++count;
  }
  if (!problem.window_share.empty() && count > 0) render_s_ = sum_s / count;
}

bool Budget::fits(const PassCost& cost, std::size_t views) const {
  return !given() || kCaution * foreseen_s(double(views) * cost.per_view) <= cost.share * left_s();
}

void Budget::loaded(std::string_view name, const ViewWork& work, double seconds) {
  if (given()) laps_.push_back({{"stage", name}, {"foreseen_s", foreseen_s(work)}, {"took_s", seconds}});
}

void Budget::took(std::string_view name, const ViewWork& work, double seconds) {
  loaded(name, work, seconds);
  if (given()) pace_.add(unpaced_s(work), seconds);
}

int Budget::epochs_that_fit(double renders, double share, int most) {
  if (!given()) return most;
  const EpochsPlan plan = plan_epochs(foreseen_s(renders), share * left_s(), kCaution, most);
  cut_ |= plan.cut;
  return plan.epochs;
}

IterationsCost Budget::contours_cost() const {
  return {.refine_s = foreseen_s(contours.refine_renders),
          .epoch_s = foreseen_s(contours.epoch_renders),
          .early_share = contours.early_share,
          .check_s = foreseen_s(contours.check_renders),
          .iterations = contours.iterations,
          .epochs = contours.epochs};
}

TimePlan Budget::plan() const {
  const StepsCost cost{.epoch_s = foreseen_s(steps.epoch_renders),
                       .field_epoch_s = foreseen_s(steps.field_epoch_renders),
                       .epochs = steps.epochs};
  return plan_time(left_s(), cost, contours_cost());
}

TimePlan Budget::plan_contours(std::optional<double> first_refine_s) const {
  IterationsCost cost = contours_cost();
  cost.refine_s = first_refine_s.value_or(cost.refine_s);
  return plan_time(left_s() + first_refine_s.value_or(0), {}, cost);
}

Json Budget::json() const {
  return {{"seconds", seconds_.value_or(0)}, {"render_s", render_s_}, {"halving_s", halving_s_},
          {"pace", pace_.factor()},          {"cut", cut_},           {"stages", laps_}};
}

std::optional<double> parse_seconds(const std::string& text) {
  if (text.empty()) return std::nullopt;
  double value = 0;
  const auto [stop, error] = scan_number(text.data(), text.data() + text.size(), value);
  const std::string unit(stop, text.data() + text.size());
  const double seconds = unit == "m" ? 60 : unit == "h" ? 3600 : 1;
  const bool known = unit.empty() || unit == "s" || unit == "m" || unit == "h";
  if (error != std::errc() || !std::isfinite(value) || !(value > 0) || !known)
    throw Error(ErrorCode::kUsage, "--time-budget: '" + text + "', expected a time such as 60s, 5m or 1h");
  return value * seconds;
}

}  // namespace ngs
