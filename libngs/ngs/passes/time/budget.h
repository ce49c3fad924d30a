#pragma once
// What --time-budget leaves time for. Every pass has a cost in renders of a view and in work on its pixels; both are
// timed when the run begins, and what the passes then take corrects the rest. A pass is begun only where it is foreseen
// to end in time, and broken off and undone where it does not; steps follow the clock itself (watch.h).
#include <optional>
#include <string_view>

#include "ngs/options/option_set.h"
#include "ngs/passes/time/time_plan.h"
#include "ngs/problem/problem.h"

namespace ngs {

/// Work on a view, or on several. A render is of the whole model; halving a picture of the view's size stands for what
/// is done to pixels, however large the model is.
struct ViewWork {
  double renders = 0, halvings = 0;
  friend ViewWork operator*(double times, const ViewWork& of) { return {times * of.renders, times * of.halvings}; }
};

/// Of a view, and the share of the time left that the pass may take at most.
struct PassCost {
  ViewWork per_view;
  double share = 1;
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

  /// Times work on the first training view, and keeps the time for writing that reading took. Only where a budget is
  /// given.
  void measure(const Exec& exec, const Problem& problem, double reading_s);
  double foreseen_s(const ViewWork& work) const { return unpaced_s(work) * pace_.factor(); }
  double foreseen_s(double renders) const { return foreseen_s(ViewWork{renders}); }
  bool fits(const PassCost& cost, std::size_t views) const;
  /// wall_seconds() when `share` of the time left will be over.
  double end_of_s(double share) const { return wall_seconds() + share * left_s(); }

  /// Until the end of its scope a pass is timed against what was foreseen for it.
  class Lap {
   public:
    Lap(Budget& budget, std::string_view name, const ViewWork& work)
        : budget_(budget), name_(name), work_(work), began_s_(wall_seconds()) {}
    ~Lap() { budget_.took(name_, work_, wall_seconds() - began_s_); }
    Lap(const Lap&) = delete;
    Lap& operator=(const Lap&) = delete;

   private:
    Budget& budget_;
    std::string_view name_;
    ViewWork work_;
    double began_s_;
  };
  Lap lap(std::string_view name, const ViewWork& work) { return {*this, name, work}; }
  Lap lap(std::string_view name, double renders) { return lap(name, ViewWork{renders}); }
  void took(std::string_view name, const ViewWork& work, double seconds);
  /// What was broken off tells nothing of the pace of the rest: as it was before.
  const Pace& pace() const { return pace_; }
  void restore(const Pace& before) { pace_ = before; }
  /// As took(), of reading files, which tells as little.
  void loaded(std::string_view name, const ViewWork& work, double seconds);

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
  double unpaced_s(const ViewWork& work) const { return work.renders * render_s_ + work.halvings * halving_s_; }
  IterationsCost contours_cost() const;

  double start_s_;
  std::optional<double> seconds_;
  double render_s_ = 0, halving_s_ = 0, closing_s_ = 0;
  Pace pace_{0.3};
  bool cut_ = false;
  Json laps_ = Json::array();
};

/// Seconds of "60s", "5m", "1h" or "90"; kUsage otherwise. Empty: none.
std::optional<double> parse_seconds(const std::string& text);

}  // namespace ngs
