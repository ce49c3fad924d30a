#pragma once
// Runs other tools as the stages of one run and collects their reports.
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "shared/run/run.h"

namespace ngs::front {

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

  /// `words`: the tool and its arguments; -w, -j, --seed and --report are added. `name`: file name of the report.
  /// Returns false if a signal stopped the run. Throws an Error with the tool's exit code and message if the tool
  /// failed; a hit budget and a failed check are no failures.
  bool run(const std::string& name, const Words& words);
  /// Sets the total number of stages, for the progress.
  void expect(std::size_t stages) { expected_ = stages; }

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
  /// The hint of the failed tool, plus its command line if the hint mentions flags that ngs cut does not have.
  std::string hint_for(const Words& words) const;

  cli::Run& run_;
  std::string folder_;
  int threads_;
  std::set<std::string> own_flags_;
  std::size_t expected_ = 1;
  std::vector<StageResult> results_;
  std::vector<std::string> names_, warnings_, commands_;
  std::string error_, hint_;  // of the running tool
};

}  // namespace ngs::front
