#include "ngs/ops/labels/label_solve.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "ngs/core/check.h"
#include "ngs/ops/optim/anderson.h"

namespace ngs {
namespace {

// Working sets. The first round folds a label if kPredictedSteps plain steps with the first gradient take it to within
// kBand of the bound to which the gradient pushes it. Exception: labels that explain more than kOwnShare of a pixel,
// because at the bound that pixel could reverse the gradient. Later rounds fold only labels exactly at a bound. A label
// that is lifted off a bound starts at kLift.
constexpr int kPredictedSteps = 4;
constexpr double kBand = 0.02, kOwnShare = 0.1, kLift = 0.02;
constexpr double kRoundingOfLoss = 1e-7;  // relative: uncertainty of the loss with float predictions
constexpr double kInnerShare = 0.8;       // of the requested gap: the target of a working set
constexpr int kMaxRounds = 50;
constexpr std::size_t kHistory = 5;  // points that a step combines
// In log-odds. Extrapolation along a curved path overshoots. Labels that are wrongly thrown to a bound cost more steps
// than they save.
constexpr double kMaxLogitStep = 2;

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

bool inner(double m) { return m > 0 && m < 1; }
double log_odds(double m) { return std::log(m / (1 - m)); }

class Solver {
 public:
  Solver(const Exec& exec, const LabelProblem& problem, const LabelSolveOptions& options,
         const std::vector<double>& start, const std::vector<std::uint8_t>& movable)
      : exec_(exec), options_(options), begin_(seconds_now()), system_(make_system(problem, start, movable)) {
    // The full system is never cached: only the weights of the working set are needed often.
    solution_.label = start;
    solution_.columns = system_.columns();
    m_.resize(std::size_t(system_.columns()));
    for (std::size_t i = 0; i < start.size(); ++i)
      if (column_of_[i] >= 0) m_[std::size_t(column_of_[i])] = start[i];
    unfoldable_.assign(m_.size(), 0);
  }

  LabelSolution run() {
    for (;; ++solution_.rounds) {
      if (solution_.rounds == 0)
        sums_ = system_.at_start();
      else
        system_.evaluate(exec_, m_, sums_);
      ++solution_.evaluations;
      record(m_, sums_, true);
      const GapPoint& now = solution_.trace.back();
      solution_.loss = now.loss;
      solution_.gap = now.gap;
      solution_.converged = now.gap <= options_.relative_gap * now.loss;
      if (solution_.converged || out_of_budget() || solution_.rounds == kMaxRounds) break;
      solve_working_set();
    }
    for (std::size_t i = 0; i < column_of_.size(); ++i)
      if (column_of_[i] >= 0) solution_.label[i] = m_[std::size_t(column_of_[i])];
    return std::move(solution_);
  }

 private:
  LabelSystem make_system(const LabelProblem& problem, const std::vector<double>& start,
                          const std::vector<std::uint8_t>& movable) {
    NGS_CHECK(start.size() == std::size_t(problem.cloud.size()) && movable.size() == start.size(),
              "solve_labels: start and movable need one value per Gaussian");
    column_of_.assign(movable.size(), -1);
    std::int32_t next = 0;
    for (std::size_t i = 0; i < movable.size(); ++i)
      if (movable[i]) column_of_[i] = next++;
    return LabelSystem(exec_, problem, column_of_, start, 0);
  }

  bool out_of_budget() const {
    return solution_.evaluations >= options_.max_evaluations || (options_.stop && options_.stop());
  }
  void record(const std::vector<double>& m, const LabelSums& sums, bool certified) {
    solution_.trace.push_back(
        {seconds_now() - begin_, sums.loss, frank_wolfe_gap(m, sums, system_.gradient_scale()), certified});
  }

  /// True if a label at distance `m` from a bound may be folded there; `predicted` is its distance after the predicted
  /// steps. `away`, `towards`: P and Q for the bound 0, Q and P for the bound 1.
  bool can_fold(double predicted, double m, double away, double towards) const {
    if (towards <= away) return false;
    return solution_.rounds == 0 ? predicted <= kBand && m * away <= kOwnShare : m <= 0;
  }

  void solve_working_set() {
    std::vector<double> predicted = m_;
    if (solution_.rounds == 0)
      for (int i = 0; i < kPredictedSteps; ++i) predicted = em_update(predicted, sums_);
    std::vector<std::int32_t> place(m_.size(), -1);
    std::vector<double> work;
    for (std::size_t c = 0; c < m_.size(); ++c) {
      const bool fold_low = can_fold(predicted[c], m_[c], sums_.inside[c], sums_.outside[c]),
                 fold_high = can_fold(1 - predicted[c], 1 - m_[c], sums_.outside[c], sums_.inside[c]);
      if (!unfoldable_[c] && (fold_low || fold_high)) {
        m_[c] = fold_low ? 0.0 : 1.0;
        continue;
      }
      if (solution_.rounds > 0) unfoldable_[c] = 1;  // once lifted off a bound, never folded again: rounds must end
      const double g = sums_.outside[c] - sums_.inside[c];
      if (m_[c] <= 0 && g < 0) m_[c] = kLift;
      if (m_[c] >= 1 && g > 0) m_[c] = 1 - kLift;
      place[c] = std::int32_t(work.size());
      work.push_back(m_[c]);
    }
    const LabelSystem reduced = system_.reduced(exec_, place, m_, options_.cache_bytes);
    if (reduced.columns() > solution_.working_columns) {
      solution_.working_columns = reduced.columns();
      solution_.cache = reduced.stats();
    }
    iterate(reduced, work);
    for (std::size_t c = 0; c < m_.size(); ++c)
      if (place[c] >= 0) m_[c] = work[std::size_t(place[c])];
  }

  /// Accelerated EM on the reduced system until its own gap is small enough.
  void iterate(const LabelSystem& system, std::vector<double>& m) {
    LabelSums now, next;
    const auto evaluate = [&](const std::vector<double>& at, LabelSums& out) {
      system.evaluate(exec_, at, out);
      ++solution_.evaluations;
    };
    Anderson history(kHistory);
    evaluate(m, now);
    for (;;) {
      record(m, now, false);
      const GapPoint& point = solution_.trace.back();
      if (point.gap <= kInnerShare * options_.relative_gap * point.loss || out_of_budget()) return;
      const std::vector<double> plain = em_update(m, now);
      std::vector<double> step = accelerated(history, m, plain, now);
      evaluate(step, next);
      if (next.loss > now.loss * (1 + kRoundingOfLoss)) {
        history.reset();
        step = plain;
        evaluate(step, next);
      }
      m = std::move(step);
      std::swap(now, next);
    }
  }

  /// The Anderson step in log-odds. The weight of a label is the number of pixels it explains, times m (1 - m). Labels
  /// at a bound, or taken to one by rounding, take the plain EM step.
  std::vector<double> accelerated(Anderson& history, const std::vector<double>& m, const std::vector<double>& plain,
                                  const LabelSums& sums) const {
    std::vector<double> x(m.size(), 0.0), f(m.size(), 0.0), weight(m.size(), 0.0);
    for (std::size_t c = 0; c < m.size(); ++c) {
      if (!inner(m[c]) || !inner(plain[c])) continue;
      x[c] = log_odds(m[c]);
      f[c] = log_odds(plain[c]) - x[c];
      weight[c] = m[c] * (1 - m[c]) * (m[c] * sums.inside[c] + (1 - m[c]) * sums.outside[c]);
    }
    const std::vector<double> to = history.next(x, f, weight);
    std::vector<double> step = plain;
    for (std::size_t c = 0; c < m.size(); ++c) {
      const double moved = 1 / (1 + std::exp(-std::clamp(to[c], x[c] - kMaxLogitStep, x[c] + kMaxLogitStep)));
      if (inner(m[c]) && inner(plain[c]) && inner(moved)) step[c] = moved;
    }
    return step;
  }

  const Exec& exec_;
  const LabelSolveOptions& options_;
  double begin_;
  std::vector<std::int32_t> column_of_;  // declared before system_, whose construction fills it
  LabelSystem system_;
  std::vector<double> m_;
  std::vector<std::uint8_t> unfoldable_;
  LabelSums sums_;
  LabelSolution solution_;
};

}  // namespace

double frank_wolfe_gap(const std::vector<double>& m, const LabelSums& sums, double gradient_scale) {
  double gap = 0;
  for (std::size_t i = 0; i < m.size(); ++i) {
    const double g = gradient_scale * (sums.outside[i] - sums.inside[i]);
    gap += std::max(g * m[i], -g * (1 - m[i]));
  }
  return gap;
}

std::vector<double> em_update(const std::vector<double>& m, const LabelSums& sums) {
  std::vector<double> out(m.size());
  for (std::size_t i = 0; i < m.size(); ++i) {
    const double object = m[i] * sums.inside[i], rest = (1 - m[i]) * sums.outside[i];
    out[i] = object + rest > 0 ? object / (object + rest) : m[i];
  }
  return out;
}

LabelSolution solve_labels(const Exec& exec, const LabelProblem& problem, const LabelSolveOptions& options,
                           const std::vector<double>& start, const std::vector<std::uint8_t>& movable) {
  return Solver(exec, problem, options, start, movable).run();
}

}  // namespace ngs
