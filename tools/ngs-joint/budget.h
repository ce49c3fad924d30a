#pragma once
// What --time-budget leaves room for. Stages that cannot stop midway are begun only where their foreseen time
// is a small part of what is left; the last ones, whose steps can end at any time, are planned to fill the
// rest.
#include <optional>

#include "ngs/stages/effect_probe.h"

namespace ngs::joint {

/// Seconds of a stage, foreseen from the time of one render: `per_view` renders for each view.
struct StageCost {
  double per_view;
  double share;  // of the time left that it may take at most
};

// Measured on two captures, rounded up (BENCHMARKS.md, Budgets).
inline constexpr StageCost kTrustCost{6, 0.1}, kFloatersCost{50, 0.35}, kDetectorCost{8, 0.25},
    kJointStepCost{12, 0.35};
inline constexpr double kWalkRenders = 15, kEdgeStepRenders = 4, kRoundRenders = 6;
inline constexpr double kClosing_s = 0.15;  // kept for writing

class Budget {
 public:
  /// `start_s`: wall_seconds() when the process began.
  Budget(double start_s, std::optional<double> seconds) : start_s_(start_s), seconds_(seconds) {}

  bool given() const { return seconds_.has_value(); }
  double left_s() const;
  double elapsed_s() const { return wall_seconds() - start_s_; }
  /// Whether what takes `next_s` may still be begun.
  bool allows(double next_s) const { return !given() || next_s <= left_s(); }

  /// Times a render of the first view; everything is foreseen from it. Only where a budget is given.
  void measure(const Exec& exec, const MethodInput& input);
  bool has_room_for(const StageCost& cost, std::size_t views) const;

  struct Rounds {
    int rounds = 0, visits = 0;  // rounds 0: none
    bool cut = false;            // less than asked for
  };
  /// As many rounds and visits of follow_edges as fit, at most those asked for.
  Rounds plan_edges(const EdgeOptions& edge, Quality quality, std::size_t views) const;

  /// Steps of the joint stage: as --quality says, or what a part of the time left has room for (all of it
  /// where nothing follows). Something is cut where that is less.
  std::int64_t steps_that_fit(const JointOptions& joint, std::size_t views, bool edges_follow);

  /// Something was left out or shortened for want of time.
  void note_cut() { cut_ = true; }
  bool cut() const { return cut_; }

 private:
  double start_s_;
  std::optional<double> seconds_;
  double render_s_ = 0;
  bool cut_ = false;
};

/// Rounds of walk and training in `left_s`: rounds go before visits only where at least half of the visits of
/// every round remain.
Budget::Rounds planned_rounds(double left_s, double round_s, double visit_s, int rounds, int visits);

}  // namespace ngs::joint
