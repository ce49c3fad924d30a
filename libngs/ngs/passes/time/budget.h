#pragma once
// What --time-budget leaves time for. Every pass has a cost in renders of a view; one render is timed when the run
// begins, and what the passes then take corrects the rest. What cannot stop midway is begun only where it is foreseen
// to end in time; steps follow the clock itself (watch.h).
#include <optional>
#include <string_view>

#include "ngs/options/option_set.h"
#include "ngs/passes/time/time_plan.h"
#include "ngs/problem/problem.h"

namespace ngs {

/// Renders per view, and the share of the time left that they may take at most.
struct PassCost {
  double renders, share = 1;
};

/// Renders of training views that the joint steps take.
struct StepsForecast {
  double epoch_renders = 0, field_epoch_renders = 0;  // field: what the NeRF adds
  int epochs = 0;
};

/// Renders of contour refinement.
struct ContourForecast {
  double refine_renders = 0, epoch_renders = 0, check_renders = 0;  // check: once, after the last iteration
  double early_share = 1;  // of the last iteration's steps, what those of another take
  int iterations = 0, epochs = 0;
};

class Budget {
 public:
  /// `start_s`: wall_seconds() when the process began. No seconds: no budget.
  Budget(double start_s, std::optional<double> seconds) : start_s_(start_s), seconds_(seconds) {}

  bool given() const { return seconds_.has_value(); }
  double left_s() const;
  double elapsed_s() const { return wall_seconds() - start_s_; }
  /// Whether what takes `next_s` may still be begun.
  bool allows(double next_s) const { return !given() || next_s <= left_s(); }

  /// Times a render of the first training view, and keeps the time for writing that reading took. Only where a budget
  /// is given.
  void measure(const Exec& exec, const Problem& problem, double reading_s);
  double foreseen_s(double renders) const { return renders * render_s_ * pace_.factor(); }
  bool fits(const PassCost& cost, std::size_t views) const;

  /// Until the end of its scope a pass is timed against what was foreseen for it.
  class Lap {
   public:
    Lap(Budget& budget, std::string_view name, double renders)
        : budget_(budget), name_(name), renders_(renders), began_s_(wall_seconds()) {}
    ~Lap() { budget_.took(name_, renders_, wall_seconds() - began_s_); }
    Lap(const Lap&) = delete;
    Lap& operator=(const Lap&) = delete;

   private:
    Budget& budget_;
    std::string_view name_;
    double renders_, began_s_;
  };
  Lap lap(std::string_view name, double renders) { return {*this, name, renders}; }
  void took(std::string_view name, double renders, double seconds);

  /// As many of `most` epochs of `renders` each as fit `share` of the time left, at least one.
  int epochs_that_fit(double renders, double share, int most);

  /// What is still to come, told by the passes that take steps.
  StepsForecast steps;
  ContourForecast contours;
  TimePlan plan() const;
  /// The same for contours alone: before the first refinement, or after it, and then by what it took.
  TimePlan plan_contours(std::optional<double> first_refine_s) const;

  /// Something was left out or shortened for want of time.
  void note_cut() { cut_ = true; }
  bool cut() const { return cut_; }
  /// "budget" of the report's result: what was foreseen and what it took.
  Json json() const;

 private:
  IterationsCost contours_cost() const;

  double start_s_;
  std::optional<double> seconds_;
  double render_s_ = 0, closing_s_ = 0;
  Pace pace_{0.3};
  bool cut_ = false;
  Json laps_ = Json::array();
};

/// Seconds of "60s", "5m", "1h" or "90"; kUsage otherwise. Empty: none.
std::optional<double> parse_seconds(const std::string& text);

}  // namespace ngs
