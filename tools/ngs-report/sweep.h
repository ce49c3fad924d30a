#pragma once
// The points of a sweep, as pipelines/work-precision.mk leaves them: OUT/points/KNOB@SETTING/REPEAT/ with
// joint.json, metrics.json, trace.jsonl and `done` (the exit code); OUT/once/NAME/reports/ with what is done
// once for a scene.
#include <array>
#include <string>
#include <vector>

#include "ngs/options/option_set.h"

namespace ngs::cli {

/// One run of a point. NaN: not measured.
struct SweepRun {
  int repeat = 0, exit_code = -1;
  double wall_s = 0, cpu_s = 0;
  Json scores;              // metrics.json "mean"; null where the run failed
  std::vector<Json> trace;  // its lines that hold a score
};

struct Spread {
  double min, median, max;  // NaN: none
};
Spread spread_of(std::vector<double> values);

struct SweepPoint {
  std::string knob, setting;
  std::vector<SweepRun> runs;
  bool frontier = false;

  std::string name() const { return knob + "@" + setting; }
  bool failed() const;  // no run of it has a score
  Spread time(bool cpu) const;
  Spread score(const std::string& name) const;
};

struct Sweep {
  std::vector<SweepPoint> points;  // by knob, then as its settings count
  Json once;                       // {"NAME": {"TOOL": seconds}}
  Json numerical;                  // numerical.json; null where there is none
};

/// Throws kBadInput where the folder holds no points.
Sweep read_sweep(const std::string& folder);

/// Marks the points that no other one beats in both time and score.
void mark_frontier(Sweep& sweep, const std::string& score, bool cpu);

/// Seconds after which a trace has reached 50, 90 and 99 % of what it gains in all; NaN: it gains nothing.
std::array<double, 3> times_to_shares(const std::vector<Json>& trace);

}  // namespace ngs::cli
