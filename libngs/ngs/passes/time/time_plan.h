#pragma once
// What the time that is left is spent on. Pure: seconds in, a plan out. The order is that of what a second
// buys (decisions/031-order-of-spending.md): an epoch of the steps, then iterations of edges, then more steps,
// the field last.

namespace ngs {

/// Seconds of the joint steps.
struct StepsCost {
  double epoch_s = 0;        // one step for every training view
  double field_epoch_s = 0;  // what the field adds to it
  int epochs = 0;            // as many as asked for
};

/// A further iteration is begun where this share of its steps fits. Half of a third one costs the capture of
/// BENCHMARKS.md 0.001 of boundary IoU; where things are thin, half of a second gains up to 0.05.
inline constexpr double kLeastIteration = 0.5;
/// The same of the last iteration where those before it are cheaper ones: it is the one that sees all pixels. A third
/// one that was cut short left the capture 0.001 below two whole ones.
inline constexpr double kLeastAfterCheap = 0.9;

/// Seconds of the edges stage; no iterations: it is off.
struct IterationsCost {
  double refine_s = 0;     // of an iteration, before its first step
  double epoch_s = 0;      // one step for every view in the last iteration
  double early_share = 1;  // of the time of the last iteration's steps, what those of another take
  double check_s = 0;      // once, after the last iteration
  int iterations = 0, epochs = 0;

  /// Of n iterations before the first step of the last.
  double before_last_s(int n) const { return n * refine_s + (n - 1) * early_share * epochs * epoch_s; }
  double all_s(int n) const { return n > 0 ? before_last_s(n) + epochs * epoch_s + check_s : 0; }
  double all_s() const { return all_s(iterations); }
  /// Least share of the last iteration's epochs with which it is begun.
  double least_last() const { return early_share < 1 ? kLeastAfterCheap : kLeastIteration; }
};

struct TimePlan {
  bool steps = true, field = true;
  double steps_s = 0;          // that the steps may take
  int contour_iterations = 0;  // 0: none
  bool cut = false;            // less than asked for
};

/// Fewer epochs than this leave an iteration of edges worse than none: it begins with halved Gaussians.
inline constexpr int kLeastContourEpochs = 3;
/// Where less than this share of a visit by the steps fits, they are left out.
inline constexpr double kLeastEpoch = 0.1;

/// The field is kept where all fits. `contour_iterations`: all but the last with all of their epochs, the last with at
/// least least_last() of its own, or kLeastContourEpochs where it is the only one. What these leave is the steps'.
TimePlan plan_time(double left_s, const StepsCost& steps, const IterationsCost& edges);

/// Visits of every view that are begun at all.
struct EpochsPlan {
  int epochs = 0;
  bool cut = false;  // fewer than asked for
};
/// All of `most` where they fit `available_s` with `caution` to spare, else as many as fit, at least one.
EpochsPlan plan_epochs(double epoch_s, double available_s, double caution, int most);

/// Seconds in this run for one foreseen, from what its stages took. A foresight of `trust_s` seconds counts as
/// much as stages that took as long.
class Pace {
 public:
  explicit Pace(double trust_s) : foreseen_s_(trust_s), took_s_(trust_s) {}
  void add(double foreseen_s, double took_s) { foreseen_s_ += foreseen_s, took_s_ += took_s; }
  double factor() const { return took_s_ / foreseen_s_; }

 private:
  double foreseen_s_, took_s_;
};

}  // namespace ngs
