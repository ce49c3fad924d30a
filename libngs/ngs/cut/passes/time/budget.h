#pragma once
// The time budget of the process (--time-budget). No cost is predicted. A pass before the joint steps may use a share
// of the time left; a pass that exceeds its share is aborted and undone. Joint steps and contour iterations poll the
// clock (step_tracker.h).
#include <optional>

#include "ngs/options/option_set.h"

namespace ngs {

/// Maximum share of the time left for: loading the views; one pass; the joint steps before contour refinement. The
/// passes are ordered by their gain per second (decision 031).
inline constexpr double kLoadShare = 0.4, kPassShare = 0.3, kStepsShare = 0.25;

class Budget {
 public:
  /// `start_s`: wall_seconds() at the start of the process. `seconds`: nullopt: no budget.
  Budget(double start_s, std::optional<double> seconds) : start_s_(start_s), seconds_(seconds) {}

  bool is_set() const { return seconds_.has_value(); }
  double elapsed_s() const;
  double remaining_s() const;
  /// True: work of `next_s` seconds still fits.
  bool allows(double next_s) const { return !is_set() || next_s <= remaining_s(); }
  /// wall_seconds() after `share` of the time left.
  double deadline_s(double share) const;
  /// Reserves time to write the result, estimated from the time that reading the model took.
  void reserve_for_writing(double reading_s);

  /// Records that work was skipped or shortened for lack of time.
  void mark_partial() { partial_ = true; }
  bool is_partial() const { return partial_; }
  /// "budget" of the report's result.
  Json json() const;

 private:
  double start_s_;
  std::optional<double> seconds_;
  double writing_s_ = 0;
  bool partial_ = false;
};

}  // namespace ngs
