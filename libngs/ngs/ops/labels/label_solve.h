#pragma once
// Labels that minimise the mask loss with fixed geometry, with a certificate of optimality (paper.md §5.3).
//
// The problem is convex (label_system.h). Update: EM of the mixture q = Σ w m in log-odds,
//   logit m <- logit m + ω (logit EM(m) - logit m),   EM(m) = m P / (m P + (1 - m) Q),
// combined with the last steps (anderson.h). Plain EM never increases the loss; a combined step that does is replaced
// by a plain one. Labels that the gradient holds at a bound are folded, and the other labels are solved separately on
// cached weights (working sets). The full system is never cached. It is composited again once per round for g = ∂L/∂m
// and the Frank-Wolfe gap over all movable labels,
//   gap(m) = Σ_i max(g_i m_i, -g_i (1 - m_i)) >= L(m) - min L,
// an upper bound on the gain of any further optimisation. The gap needs no ground truth.
#include <functional>

#include "ngs/ops/labels/label_system.h"

namespace ngs {

struct LabelSolveOptions {
  double relative_gap = 1e-3;  // stop when gap <= relative_gap · loss
  int max_evaluations = 2000;
  std::int64_t cache_bytes = std::int64_t(2) << 30;  // for the weights of a working set, see label_system.h
  std::function<bool()> stop;                        // called once per evaluation; may be empty
};

/// The state of the solver at one time. `certified`: the gap is over all labels; otherwise over the working set, with
/// the other labels fixed.
struct GapPoint {
  double seconds = 0, loss = 0, gap = 0;
  bool certified = false;
};

struct LabelSolution {
  std::vector<double> label;  // [N] in [0, 1]
  double loss = 0, gap = 0;   // at `label`, over all movable Gaussians
  bool converged = false;     // gap <= relative_gap · loss
  int evaluations = 0, rounds = 0;
  std::int64_t columns = 0;          // movable labels
  std::int64_t working_columns = 0;  // of the largest working set
  LabelSystem::Stats cache;          // of the largest working set
  std::vector<GapPoint> trace;
};

/// Starts at the labels `start` [N], which may be exactly 0 or 1. Gaussians with movable[i] == 0 keep their label.
LabelSolution solve_labels(const Exec& exec, const LabelProblem& problem, const LabelSolveOptions& options,
                           const std::vector<double>& start, const std::vector<std::uint8_t>& movable);

/// Frank-Wolfe gap of the box [0, 1]^n at m.
double frank_wolfe_gap(const std::vector<double>& m, const LabelSums& sums, double gradient_scale);

/// One EM update. It never increases the loss; a label at exactly 0 or 1 stays.
std::vector<double> em_update(const std::vector<double>& m, const LabelSums& sums);

}  // namespace ngs
