#pragma once
// What --time-budget leaves room for. Every stage has a cost in renders, one render is timed when the run
// begins, and what the stages then take corrects the rest. Stages that cannot stop midway are begun only
// where they are foreseen to end in time; the steps follow the time itself (watch.h).
#include <optional>
#include <string>
#include <vector>

#include "ngs/passes/effect_probe.h"
#include "ngs/passes/time_plan.h"
#include "shared/tool.h"

namespace ngs::joint {

/// Renders per view that a stage takes, and the share of the time left that it may take at most.
struct StageCost {
  std::string_view name;
  double renders;
  double share;
};

// Measured on the captures of BENCHMARKS.md (Budgets); a run corrects them by its own pace.
inline constexpr StageCost kMaskOutliersCost{"mask-outliers", 1.5, 0.15}, kFloatersCost{"floaters", 8, 0.2},
    kFloaterSearchCost{"floaters", 5.5, 1}, kDetectorsCost{"detectors", 1.5, 0.6},
    kDraftFloatersCost{"floaters", 8, 0.7}, kDraftSearchCost{"floaters", 4, 1},
    kRefitEpochCost{"refit", 4.5, 0.12}, kCheckCost{"check", 1.2, 1}, kLoadCost{"load views", 2, 0.4};
inline constexpr double kStepRenders = 3, kFieldStepRenders = 7, kRefineRenders = 10, kContourStepRenders = 2.7;

class Budget {
 public:
  /// `start_s`: wall_seconds() when the process began.
  Budget(double start_s, std::optional<double> seconds) : start_s_(start_s), seconds_(seconds) {}

  bool given() const { return seconds_.has_value(); }
  double left_s() const;
  double elapsed_s() const { return wall_seconds() - start_s_; }
  /// Whether what takes `next_s` may still be begun.
  bool allows(double next_s) const { return !given() || next_s <= left_s(); }

  /// Times a render of the first view, and keeps the time for writing that reading took. Only where a budget
  /// is given.
  void measure(const Exec& exec, const Problem& input, double reading_s);
  double foreseen_s(double renders) const { return renders * render_s_ * pace_.factor(); }
  bool fits(const StageCost& cost, std::size_t views) const;

  /// Until the end of its scope a stage is timed against what was foreseen for it.
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
  Lap lap(const StageCost& cost, std::size_t views) {
    return {*this, cost.name, cost.renders * double(views)};
  }
  void took(std::string_view name, double renders, double seconds);

  /// Visits of every view, at 1 / shrink of its size, to refit the colours that floaters covered: few for a draft, and
  /// as many as there is room for.
  int plan_refit(bool draft, int shrink, std::size_t views);
  Lap lap_refit(int epochs, int shrink, std::size_t views);

  /// Steps of Eq. 20 that the run has taken.
  void took_steps(std::int64_t steps, bool field, double seconds) { took("steps", double(steps) * step_renders(field), seconds); }
  /// Whether there is still room for more than one of them.
  bool steps_fit(bool field) const { return allows(2 * foreseen_s(step_renders(field))); }

  /// What is left for steps and edges; for edges alone, before the first walk, or after it, and then by what it took.
  TimePlan plan(const JointOptions& joint, const ContourOptions& edge, const Scene& scene,
                std::size_t training_views) const;
  TimePlan plan_iterations(const JointOptions& joint, const ContourOptions& edge, const Scene& scene,
                       std::size_t training_views, std::optional<double> first_refine_s) const;

  /// Something was left out or shortened for want of time.
  void note_cut() { cut_ = true; }
  bool cut() const { return cut_; }
  /// "budget" of the report's result: what was foreseen and what it took.
  Json json() const;

 private:
  IterationsCost iterations_cost(const JointOptions& joint, const ContourOptions& edge, const Scene& scene,
                         std::size_t training_views) const;
  static double step_renders(bool field) { return kStepRenders + (field ? kFieldStepRenders : 0); }

  double start_s_;
  std::optional<double> seconds_;
  double render_s_ = 0, closing_s_ = 0;
  Pace pace_{0.3};
  bool cut_ = false;
  Json laps_ = Json::array();
};

}  // namespace ngs::joint
