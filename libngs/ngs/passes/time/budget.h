#pragma once
// When the process is to end (--time-budget). No cost is predicted. A pass before the steps may take a share of the
// time that is left; one that takes longer is aborted and undone. Steps and contour iterations follow the clock
// (watch.h).
#include <optional>
#include <string>

#include "ngs/options/option_set.h"

namespace ngs {

/// Most of the time left that loading the views, a pass, or the joint steps before contour refinement may take. The
/// order of the passes is that of what a second gains (decision 031).
inline constexpr double kLoadShare = 0.4, kPassShare = 0.3, kStepsShare = 0.25;

class Budget {
 public:
  /// `start_s`: wall_seconds() when the process began. No seconds: no budget.
  Budget(double start_s, std::optional<double> seconds) : start_s_(start_s), seconds_(seconds) {}

  bool given() const { return seconds_.has_value(); }
  double elapsed_s() const;
  double left_s() const;
  /// Whether what takes `next_s` may still begin.
  bool allows(double next_s) const { return !given() || next_s <= left_s(); }
  /// wall_seconds() when `share` of the time left will be over.
  double end_of_s(double share) const;
  /// Keeps the time to write the result, which takes about as long as reading the model took.
  void keep_for_writing(double reading_s);

  /// Something was left out or shortened for want of time.
  void note_cut() { cut_ = true; }
  bool cut() const { return cut_; }
  /// "budget" of the report's result.
  Json json() const;

 private:
  double start_s_;
  std::optional<double> seconds_;
  double closing_s_ = 0;
  bool cut_ = false;
};

/// Seconds of "60s", "5m", "1h" or "90"; kUsage otherwise. Empty: none.
std::optional<double> parse_seconds(const std::string& text);

}  // namespace ngs
