#include "ngs/ops/label_solve.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "ngs/core/check.h"

namespace ngs {
namespace {

// Working sets. After kFullSteps plain steps of all labels, those within kBand of a bound that the gradient
// holds them to are tried at the bound. Later rounds fold only what stands at a bound exactly. A label lifted
// off one starts at kLift.
constexpr int kFullSteps = 2;
constexpr double kBand = 1e-3, kLift = 0.02;
constexpr double kRoundingOfLoss = 1e-7;  // relative: what float predictions leave uncertain
constexpr double kFirstShare = 10,
                 kInnerShare = 0.8;  // of the wanted gap, left to the first and to later working sets
constexpr int kMaxRounds = 50;

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double relaxed(double from, double to, double omega) {
  if (!(from > 0 && from < 1 && to > 0 && to < 1)) return to;
  const double odds = std::log(from / (1 - from)), target = std::log(to / (1 - to));
  const double x = odds + omega * (target - odds);
  const double m = 1 / (1 + std::exp(-x));
  return m > 0 && m < 1 ? m : to;
}

class Solver {
 public:
  Solver(const Exec& exec, const LabelProblem& problem, const LabelSolveOptions& options,
         const std::vector<double>& start, const std::vector<std::uint8_t>& movable)
      : exec_(exec), options_(options), begin_(seconds_now()), system_(make_system(problem, start, movable)) {
    solution_.label = start;
    solution_.columns = system_.columns();
    solution_.cache = system_.stats();
    m_.resize(std::size_t(system_.columns()));
    for (std::size_t i = 0; i < start.size(); ++i)
      if (column_of_[i] >= 0) m_[std::size_t(column_of_[i])] = start[i];
    kept_.assign(m_.size(), 0);
  }

  LabelSolution run() {
    for (;; ++solution_.rounds) {
      system_.evaluate(exec_, m_, sums_);
      ++solution_.evaluations;
      note(m_, sums_, true);
      const GapPoint& now = solution_.trace.back();
      solution_.loss = now.loss, solution_.gap = now.gap;
      solution_.converged = now.gap <= options_.relative_gap * now.loss;
      if (solution_.converged || out_of_budget() || solution_.rounds == kMaxRounds) break;
      if (solution_.rounds == 0) step_all();
      solve_working_set();
    }
    for (std::size_t i = 0; i < column_of_.size(); ++i)
      if (column_of_[i] >= 0) solution_.label[i] = m_[std::size_t(column_of_[i])];
    return std::move(solution_);
  }

 private:
  /// Columns: the movable labels that are not at a bound, and those at a bound that some pixel speaks
  /// against.
  LabelSystem make_system(const LabelProblem& problem, const std::vector<double>& start,
                          const std::vector<std::uint8_t>& movable) {
    NGS_CHECK(start.size() == std::size_t(problem.cloud.size()) && movable.size() == start.size(),
              "labels to solve for");
    std::vector<std::uint8_t> column(start.size());
    for (std::size_t i = 0; i < start.size(); ++i) column[i] = movable[i] && start[i] > 0 && start[i] < 1;
    number_columns(column);
    LabelSystem system(exec_, problem, column_of_, start, options_.cache_bytes / 2);
    bool complete = true;
    for (std::size_t i = 0; i < start.size(); ++i)
      if (movable[i] && !column[i] && system.weight_against()[i] > 0) column[i] = 1, complete = false;
    if (complete) return system;
    number_columns(column);
    return LabelSystem(exec_, problem, column_of_, start, options_.cache_bytes / 2);
  }
  void number_columns(const std::vector<std::uint8_t>& column) {
    column_of_.assign(column.size(), -1);
    std::int32_t next = 0;
    for (std::size_t i = 0; i < column.size(); ++i)
      if (column[i]) column_of_[i] = next++;
  }

  bool out_of_budget() const {
    return solution_.evaluations >= options_.max_evaluations || (options_.stop && options_.stop()) ||
           (options_.time_budget_s > 0 && seconds_now() - begin_ > options_.time_budget_s);
  }
  void note(const std::vector<double>& m, const LabelSums& sums, bool certified) {
    solution_.trace.push_back(
        {seconds_now() - begin_, sums.loss, frank_wolfe_gap(m, sums, system_.gradient_scale()), certified});
  }

  /// A label that starts almost at a bound but is wanted elsewhere moves there in a step or two: the working
  /// set is better chosen after them.
  void step_all() {
    for (int i = 0; i < kFullSteps && !out_of_budget(); ++i) {
      m_ = em_update(m_, sums_);
      system_.evaluate(exec_, m_, sums_);
      ++solution_.evaluations;
      note(m_, sums_, true);
    }
  }

  void solve_working_set() {
    const double band = solution_.rounds == 0 ? kBand : 0.0;
    std::vector<std::int32_t> place(m_.size(), -1);
    std::vector<double> work;
    for (std::size_t c = 0; c < m_.size(); ++c) {
      const double g = sums_.outside[c] - sums_.inside[c];
      const bool held_low = m_[c] <= band && g > 0, held_high = m_[c] >= 1 - band && g < 0;
      if (!kept_[c] && (held_low || held_high)) {
        m_[c] = held_low ? 0.0 : 1.0;
        continue;
      }
      if (solution_.rounds > 0) kept_[c] = 1;  // once lifted off a bound, never folded again: rounds must end
      if (m_[c] <= 0 && g < 0) m_[c] = kLift;
      if (m_[c] >= 1 && g > 0) m_[c] = 1 - kLift;
      place[c] = std::int32_t(work.size());
      work.push_back(m_[c]);
    }
    const LabelSystem reduced = system_.reduced(exec_, place, m_, options_.cache_bytes / 2);
    iterate(reduced, work);
    for (std::size_t c = 0; c < m_.size(); ++c)
      if (place[c] >= 0) m_[c] = work[std::size_t(place[c])];
  }

  /// Over-relaxed EM on the reduced system until its own gap is small enough.
  void iterate(const LabelSystem& system, std::vector<double>& m) {
    LabelSums now, next;
    const auto evaluate = [&](const std::vector<double>& at, LabelSums& out) {
      system.evaluate(exec_, at, out);
      ++solution_.evaluations;
    };
    evaluate(m, now);
    for (;;) {
      note(m, now, false);
      const GapPoint& point = solution_.trace.back();
      const double share = solution_.rounds == 0 ? kFirstShare : kInnerShare;
      if (point.gap <= share * options_.relative_gap * point.loss || out_of_budget()) return;
      const std::vector<double> plain = em_update(m, now);
      std::vector<double> step = plain;
      for (std::size_t c = 0; c < m.size(); ++c) step[c] = relaxed(m[c], plain[c], options_.relaxation);
      evaluate(step, next);
      if (next.loss > now.loss * (1 + kRoundingOfLoss)) step = plain, evaluate(step, next);
      m = std::move(step);
      std::swap(now, next);
    }
  }

  const Exec& exec_;
  const LabelSolveOptions& options_;
  double begin_;
  std::vector<std::int32_t> column_of_;  // before system_, which its construction fills it for
  LabelSystem system_;
  std::vector<double> m_;
  std::vector<std::uint8_t> kept_;
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
