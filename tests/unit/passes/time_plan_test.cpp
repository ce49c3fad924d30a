#include "ngs/passes/time/time_plan.h"

#include <doctest/doctest.h>

#include "ngs/passes/time/budget.h"
#include "support/joint_case.h"

namespace ngs {
namespace {

constexpr StepsCost kSteps{.epoch_s = 1, .field_epoch_s = 2, .epochs = 10};
constexpr IterationsCost kRounds{
    .refine_s = 3, .epoch_s = 1, .early_share = 1, .check_s = 0.5, .iterations = 2, .epochs = 15};

}  // namespace

TEST_CASE("where everything fits into the time nothing is cut, and what is left over goes to the steps") {
  const TimePlan plan = plan_time(30 + 36.5, kSteps, kRounds);
  CHECK_FALSE(plan.cut);
  CHECK((plan.steps && plan.field && plan.contour_iterations == 2));
  CHECK(plan.steps_s == doctest::Approx(30));
}

TEST_CASE(
    "what does not fit is cut in the order of the gain per second: field, steps, second contour iteration, contours") {
  const TimePlan no_field = plan_time(60, kSteps, kRounds);
  CHECK((no_field.cut && !no_field.field && no_field.contour_iterations == 2));
  CHECK(no_field.steps_s == doctest::Approx(60 - 36.5));
  const TimePlan short_steps = plan_time(38, kSteps, kRounds);
  CHECK(short_steps.contour_iterations == 2);
  CHECK(short_steps.steps_s == doctest::Approx(1.5));
  const TimePlan shortened = plan_time(1 + 0.5 + 2 * 3 + 15 + 7.5, kSteps, kRounds);
  CHECK(shortened.contour_iterations == 2);
  CHECK(shortened.steps_s == doctest::Approx(1));
  CHECK(plan_time(1 + 0.5 + 2 * 3 + 15 + 7.4, kSteps, kRounds).contour_iterations == 1);
  CHECK(plan_time(1 + 0.5 + 3 + 3, kSteps, kRounds).contour_iterations == 1);
  const TimePlan steps_alone = plan_time(7.4, kSteps, kRounds);
  CHECK((steps_alone.contour_iterations == 0 && steps_alone.steps));
  CHECK(steps_alone.steps_s == doctest::Approx(7.4));
}

TEST_CASE(
    "iterations before the last take all of their epochs at their own cost, so cheap ones leave time for one more") {
  IterationsCost cheap = kRounds;
  cheap.early_share = 0.5;
  CHECK(cheap.all_s() == doctest::Approx(kRounds.all_s() - 15 * 0.5));
  const double shortest_s = 1 + 0.5 + 2 * 3 + 7.5 + 0.9 * 15;  // the last one nearly whole: it is what they are for
  CHECK(plan_time(shortest_s - 0.1, kSteps, cheap).contour_iterations == 1);
  CHECK(plan_time(shortest_s + 0.1, kSteps, cheap).contour_iterations == 2);
  CHECK(plan_time(shortest_s - 1, kSteps, kRounds).contour_iterations == 1);
}

TEST_CASE("the time of an iteration that does not fit goes to the steps") {
  const TimePlan plan = plan_time(1 + 0.5 + 2 * 3 + 15 + 7.4, kSteps, kRounds);
  REQUIRE(plan.contour_iterations == 1);
  CHECK(plan.steps_s == doctest::Approx(1 + 3 + 15 + 7.4 - 15));
}

TEST_CASE("more time never plans fewer iterations, nor less than one epoch of steps where less time planned one") {
  int iterations = 0;
  for (double left_s = -1; left_s < 90; left_s += 0.25) {
    CAPTURE(left_s);
    const TimePlan plan = plan_time(left_s, kSteps, kRounds);
    CHECK(plan.contour_iterations >= iterations);
    CHECK(plan.steps == (left_s >= 0.1));
    CHECK(plan.steps_s >= (left_s >= 1 ? 1 : 0));
    iterations = plan.contour_iterations;
  }
}

TEST_CASE("without time, steps or edges there is a plan too") {
  const TimePlan nothing = plan_time(-2, kSteps, kRounds);
  CHECK((nothing.cut && !nothing.steps && nothing.contour_iterations == 0 && nothing.steps_s == 0));
  const TimePlan edges_alone = plan_time(100, {}, kRounds);
  CHECK((!edges_alone.steps && edges_alone.contour_iterations == 2 && !edges_alone.cut));
  const TimePlan steps_alone = plan_time(4, kSteps, {});
  CHECK((steps_alone.steps && steps_alone.contour_iterations == 0 && steps_alone.cut));
  CHECK(steps_alone.steps_s == doctest::Approx(4));
}

TEST_CASE("pace: the estimate follows long stages and hardly one slow short one") {
  Pace pace(0.5);
  CHECK(pace.factor() == 1);
  pace.add(0.01, 0.1);
  CHECK(pace.factor() < 1.2);
  pace.add(5, 10);
  CHECK(pace.factor() == doctest::Approx(10.6 / 5.51));
}

TEST_CASE("epochs that fit only without the safety margin are all begun, and nothing is cut") {
  const auto planned = [](double available_s) { return plan_epochs(2, available_s, 1.25, 4); };
  CHECK((planned(10).epochs == 4 && !planned(10).cut));
  CHECK((planned(9).epochs == 4 && !planned(9).cut));  // naive: no room with caution, hence cut
  CHECK((planned(8).epochs == 4 && !planned(8).cut));
  CHECK((planned(7.9).epochs == 3 && planned(7.9).cut));
  CHECK((planned(0).epochs == 1 && planned(0).cut));
  CHECK((planned(-3).epochs == 1 && planned(-3).cut));
}

TEST_CASE("budget: work is foreseen in renders and in halvings of a picture, both of which are timed") {
  const auto c = test::joint_case();
  const Problem in = c->input();
  Budget budget(wall_seconds(), 1000.0);
  budget.measure({}, in, 0);
  const double render_s = budget.foreseen_s(1), halving_s = budget.foreseen_s(ViewWork{.halvings = 1});
  CHECK(render_s > 0);
  CHECK(halving_s > 0);
  CHECK(budget.foreseen_s(3.0 * ViewWork{2, 5}) == doctest::Approx(6 * render_s + 15 * halving_s));
  CHECK(budget.fits({{.renders = 1}, 1}, 4));
  CHECK_FALSE(budget.fits({{.renders = 2000 / render_s}, 1}, 4));
  CHECK_FALSE(budget.fits({{.halvings = 2000 / halving_s}, 1}, 4));
}

TEST_CASE("budget: what passes take sets the pace of the rest, what reading files takes does not") {
  const auto c = test::joint_case();
  const Problem in = c->input();
  Budget budget(wall_seconds(), 1000.0);
  budget.measure({}, in, 0);
  const double before_s = budget.foreseen_s(1);
  budget.loaded("files", {.renders = 1}, 50);
  CHECK(budget.foreseen_s(1) == before_s);
  budget.took("pass", {.renders = 1}, 50);
  CHECK(budget.foreseen_s(1) > 10 * before_s);
  CHECK(budget.json().at("stages").size() == 2);
}

}  // namespace ngs
