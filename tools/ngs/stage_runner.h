#pragma once
// Runs other tools as the stages of one run and collects their reports.
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "cut_inputs.h"
#include "shared/progress/chain_clock.h"
#include "shared/run/run.h"

namespace ngs::ngs_tool {

// The steps of ngs cut: names for people, tools, files and expected times.
struct PlannedStep {
  std::string name;         // of the stage, as for StageRunner
  std::string words;        // what is done: "sharpening the edge"
  std::string tool;         // "ngs-joint"; "ngs cut": in this process
  std::string files;        // what it writes, relative to the output folder
  double share = 1;         // expected time in seconds, of a small splat
  bool has_passes = false;  // its progress restarts
};

struct PlanFacts {
  bool marked = false;           // there are strokes
  bool has_masks = false;        // of the scene, of the capture, or given
  bool reuses_pictures = false;  // of an earlier run
};

/// In the order in which they run.
std::vector<PlannedStep> planned_steps(const CutOptions& options, const CutInputs& inputs, const PlanFacts& facts);

/// A table of the steps: number, words, tool, files.
std::string plan_text(const std::vector<PlannedStep>& steps, const std::string& out);

using Words = std::vector<std::string>;

struct StageResult {
  std::string tool;
  double wall_s = 0;
  nlohmann::json report;
};

class StageRunner {
 public:
  /// Reports and command lines go to `folder`/reports, where ngs-report reads them. A dry run only collects the command
  /// lines. `own_flags`: flags of ngs cut, which hints may mention without the name of a tool.
  StageRunner(cli::Run& run, std::string folder, int threads, std::set<std::string> own_flags);
  ~StageRunner();
  StageRunner(const StageRunner&) = delete;
  StageRunner& operator=(const StageRunner&) = delete;

  /// `words`: the tool and its arguments; -w, -j, --seed, --report and --device are added. `name`: file name of the
  /// report. Returns false if a signal stopped the run. Throws an Error with the tool's exit code and message if the
  /// tool failed; a hit budget and a failed check are no failures.
  bool run(const std::string& name, const Words& words);
  /// Sets the steps of the whole run, for the progress. Call it before the first step begins.
  void plan(std::vector<PlannedStep> steps);
  const std::vector<PlannedStep>& steps() const { return steps_; }
  /// Begins a step that runs in this process; run() calls it for the others. A step that is not planned belongs to the
  /// current one.
  void begin(const std::string& name);

  const std::vector<StageResult>& results() const { return results_; }
  /// Report of the latest stage of this name; null if there is none.
  const nlohmann::json& report(const std::string& name) const;
  /// Warnings of all stages, as "ngs-mask: ...".
  const std::vector<std::string>& warnings() const { return warnings_; }
  const std::vector<std::string>& commands() const { return commands_; }
  /// True if a message of a stage mentions a flag that ngs cut does not have. Flags after the name of a tool belong to
  /// that tool.
  bool names_flag_of_stage(const std::string& text) const;

 private:
  void on_output_line(const std::string& line);
  void show_progress(std::int64_t done, std::int64_t total);
  /// The hint of the failed tool, plus its command line if the hint mentions flags that ngs cut does not have.
  std::string hint_for(const Words& words) const;

  cli::Run& run_;
  std::string folder_;
  int threads_;
  std::set<std::string> own_flags_;
  std::vector<PlannedStep> steps_;
  std::size_t step_ = 0;  // index of the current step
  cli::ChainClock clock_{std::vector<cli::ChainStep>()};
  std::vector<StageResult> results_;
  std::vector<std::string> names_, warnings_, commands_;
  std::string error_, hint_;  // of the running tool
};

}  // namespace ngs::ngs_tool
