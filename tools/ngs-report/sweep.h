#pragma once
// Reads a sweep of pipelines/work-precision.mk: OUT/points/KNOB@SETTING/REPEAT/ with joint.json, metrics.json,
// trace.jsonl and `done` (the exit code); OUT/once/NAME/reports/ with the reports of one-off steps per scene.
#include <array>
#include <string>
#include <vector>

#include "ngs/options/option_set.h"

namespace ngs::cli {

/// One run of a sweep point. NaN: not measured.
struct SweepRun {
  int repeat = 0, exit_code = -1;
  double wall_s = 0, cpu_s = 0;
  Json scores;              // metrics.json "mean"; null where the run failed
  std::vector<Json> trace;  // trace lines with a score
};

struct Spread {
  double min, median, max;  // NaN: none
};
Spread spread_of(std::vector<double> values);

struct SweepPoint {
  std::string knob, setting;
  std::vector<SweepRun> runs = {};
  bool frontier = false;

  std::string name() const { return knob + "@" + setting; }
  bool failed() const;  // no run has a score
  Spread time(bool cpu) const;
  Spread score(const std::string& name) const;
};

struct Sweep {
  std::vector<SweepPoint> points;  // sorted by knob, then by setting
  Json once;                       // {"NAME": {"TOOL": seconds}}
  Json numerical;                  // numerical.json; null where there is none
};

/// Throws kBadInput if the folder contains no finished point.
Sweep read_sweep(const std::string& folder);

/// Marks the Pareto-optimal points in time and score.
void mark_frontier(Sweep& sweep, const std::string& score, bool cpu);

/// Seconds after which a trace reached 50, 90 and 99 % of its total gain; NaN without gain.
std::array<double, 3> times_to_shares(const std::vector<Json>& trace);

// ngs-report work-precision: time and accuracy of each setting of each knob, as a page, JSON and CSV.

struct SweepView {
  std::string score;  // name in metrics.json "mean"
  bool cpu;           // CPU seconds instead of wall time
};

std::string sweep_page(const Sweep& sweep, const SweepView& view);
Json sweep_json(const Sweep& sweep, const SweepView& view);
std::string sweep_csv(const Sweep& sweep);

int work_precision_command(int argc, char** argv);

}  // namespace ngs::cli
