#pragma once
// Progress of a run of several steps as one fraction, which never falls, and an estimate of the remaining time, which
// never grows. A step may report several passes, each from 0 again; its elapsed time then replaces its reports.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace ngs::cli {

struct ChainStep {
  double share = 1;         // expected time, in any unit
  bool has_passes = false;  // reports several passes
};

class ChainClock {
 public:
  explicit ChainClock(std::vector<ChainStep> steps) : steps_(std::move(steps)) {}

  /// Ends the current step and begins another; steps in between are left out.
  void begin(std::size_t step, double now_s) {
    end_step(now_s);
    for (std::size_t k = next_; k < std::min(step, steps_.size()); ++k) steps_[k].share = 0;
    current_ = std::min(step, steps_.size());
    next_ = current_ + 1;
    began_s_ = now_s;
    fraction_ = 0;
    has_passes_ = current_ < steps_.size() && steps_[current_].has_passes;
  }

  void update(double fraction) {
    has_passes_ |= fraction < fraction_;
    fraction_ = std::max(fraction_, std::clamp(fraction, 0.0, 1.0));
  }

  /// Fraction of the whole run that is done, in [0, 1].
  double done(double now_s) {
    if (current_ == kNone) return done_;
    double before = 0, all = 0;
    for (std::size_t k = 0; k < steps_.size(); ++k) {
      all += steps_[k].share;
      if (k < current_) before += steps_[k].share;
    }
    if (all > 0) done_ = std::max(done_, std::min(1.0, (before + share() * within(now_s)) / all));
    return done_;
  }

  /// Remaining seconds; negative: unknown, since no step has shown its pace yet.
  double left_s(double now_s) {
    const double pace_s = pace(now_s);
    if (!(pace_s > 0) || done(now_s) < kMinSpent) return left_s_;
    double rest = share() * (1 - within(now_s));
    for (std::size_t k = next_; k < steps_.size(); ++k) rest += steps_[k].share;
    const double found_s = rest * pace_s;
    return left_s_ = left_s_ < 0 ? found_s : std::min(left_s_, found_s);
  }

 private:
  static constexpr double kLinear = 0.8;     // share of a step's expected time after which its progress slows down
  static constexpr double kMinSpent = 0.03;  // least share of the run that shows the pace of the rest
  static constexpr double kMinSeen = 0.05;   // least progress of a step that shows its pace
  static constexpr std::size_t kNone = ~std::size_t(0);

  double share() const { return current_ < steps_.size() ? steps_[current_].share : 0; }

  void end_step(double now_s) {
    if (share() > 0) {
      spent_s_ += now_s - began_s_;
      spent_share_ += share();
    }
  }

  /// Seconds per unit of the shares; 0: unknown.
  double pace(double now_s) const {
    double spent_s = spent_s_, spent = spent_share_;
    if (!has_passes_ && fraction_ >= kMinSeen) {
      spent_s += now_s - began_s_;
      spent += share() * fraction_;
    }
    return spent > 0 ? spent_s / spent : 0;
  }

  /// Fraction of the current step: what it reports, or with several passes its time as a fraction of the expected one,
  /// which approaches 1 slowly. While no pace is known, the first pass counts as half of the step.
  double within(double now_s) const {
    if (!has_passes_) return fraction_;
    const double expected_s = share() * pace(now_s);
    if (!(expected_s > 0)) return 0.5 * fraction_;
    const double x = (now_s - began_s_) / expected_s;
    return x < kLinear ? x : 1 - (1 - kLinear) * std::exp(-(x - kLinear) / (1 - kLinear));
  }

  std::vector<ChainStep> steps_;
  std::size_t current_ = kNone, next_ = 0;
  double began_s_ = 0, fraction_ = 0;
  bool has_passes_ = false;
  double spent_s_ = 0, spent_share_ = 0;  // of finished steps
  double done_ = 0, left_s_ = -1;
};

// Elapsed and remaining time of the stages that report progress. A stage whose count restarts begins another part: the
// time of earlier parts does not predict the new one. Progress of other stages in between, such as scores for a trace,
// has no influence.
class ProgressClock {
 public:
  void update(const std::string& stage, std::int64_t done, double now_s) {
    Part& part = parts_.try_emplace(stage, Part{now_s, done, done}).first->second;
    if (done < part.done) part = {now_s, done, done};
    part.done = done;
  }
  /// False if the stage has reported no progress.
  bool stage_ended(const std::string& stage) { return parts_.erase(stage) > 0; }
  double taken_s(const std::string& stage, double now_s) const { return now_s - parts_.at(stage).began_s; }
  /// Remaining time until `total`, at the pace so far; negative if there is no pace yet.
  double left_s(const std::string& stage, std::int64_t total, double now_s) const {
    const Part& part = parts_.at(stage);
    const std::int64_t pace = part.done - part.first_done;
    return pace > 0 ? (now_s - part.began_s) * double(total - part.done) / double(pace) : -1;
  }

 private:
  struct Part {
    double began_s;  // time of its first progress report
    std::int64_t first_done, done;
  };
  std::map<std::string, Part> parts_;  // by stage
};

}  // namespace ngs::cli
