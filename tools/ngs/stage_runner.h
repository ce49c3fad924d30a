#pragma once
// Runs other tools as the stages of one run and collects their reports.
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "cut_plan.h"
#include "shared/progress/chain_clock.h"
#include "shared/run/run.h"

namespace ngs::ngs_tool {

struct StageResult {
  std::string tool;
  double wall_s = 0;
  nlohmann::json report;
};

class StageRunner {
 public:
  /// Reports and command lines go to `folder`/reports, where ngs-report reads them. `own_flags`: flags of ngs cut,
  /// which hints may mention without the name of a tool.
  StageRunner(cli::Run& run, std::string folder, int threads, std::set<std::string> own_flags);
  ~StageRunner();
  StageRunner(const StageRunner&) = delete;
  StageRunner& operator=(const StageRunner&) = delete;

  /// Runs the command of the step, with -w, -j, --seed, --report and --device. Returns false if a signal stopped the
  /// run. Throws an Error with the tool's exit code and message if the tool failed; a hit budget and a failed check are
  /// no failures.
  bool run(const PlannedStep& step);
  /// Sets the steps of the whole run, for the progress. The same number of steps again: only commands of later steps
  /// have changed.
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
  /// Command lines of the planned steps, without those of this process.
  Words commands() const;
  /// True if a message of a stage mentions a flag that ngs cut does not have. Flags after the name of a tool belong to
  /// that tool.
  bool names_flag_of_stage(const std::string& text) const;

 private:
  void on_output_line(const std::string& line);
  void show_progress(std::int64_t done, std::int64_t total);
  /// The hint of the failed tool, plus its command line if the hint mentions flags that ngs cut does not have.
  std::string hint_for(const PlannedStep& step) const;
  std::string report_path(const PlannedStep& step) const { return folder_ + "/reports/" + step.name + ".json"; }
  /// The command of a step with the options of every stage.
  Words full_command(const PlannedStep& step) const;

  cli::Run& run_;
  std::string folder_;
  int threads_;
  std::set<std::string> own_flags_;
  std::vector<PlannedStep> steps_;
  std::size_t step_ = 0;  // index of the current step
  cli::ChainClock clock_{std::vector<cli::ChainStep>()};
  std::vector<StageResult> results_;
  std::vector<std::string> names_, warnings_;
  std::string error_, hint_;  // of the running tool
};

}  // namespace ngs::ngs_tool
