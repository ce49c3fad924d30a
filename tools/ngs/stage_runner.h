#pragma once
// Runs sibling tools as the stages of one run, and remembers what they reported.
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
  /// Reports and command lines go to `folder`/reports, where ngs-report looks for them. A dry run only collects the
  /// command lines.
  /// `own_flags`: those that a hint may name without saying whose they are.
  StageRunner(cli::Run& run, std::string folder, int threads, std::set<std::string> own_flags);

  /// `words`: the tool and its arguments; -w, -j, --seed and --report are added. `name` is that of the report's file.
  /// False: a signal asked to stop, nothing further is to be done. An Error with the tool's own code and message where
  /// it failed; a hit budget and a failed check are results.
  bool run(const std::string& name, const Words& words);
  /// For the progress: how many stages there will be, those that are done among them.
  void expect(std::size_t stages) { expected_ = stages; }

  const std::vector<StageResult>& results() const { return results_; }
  /// Of the latest stage of this name; null where there is none.
  const nlohmann::json& report(const std::string& name) const;
  /// "ngs-mask: ..." of all stages.
  const std::vector<std::string>& warnings() const { return warnings_; }
  const std::vector<std::string>& commands() const { return commands_; }
  /// Whether a message of a stage names a flag that only the stage has. Those behind the name of a tool are that
  /// tool's.
  bool names_flag_of_stage(const std::string& text) const;

 private:
  void listen(const std::string& line);
  /// The hint of the tool that failed; with its command line where it names flags that only the tool has.
  std::string hint_for(const Words& words) const;

  cli::Run& run_;
  std::string folder_;
  int threads_;
  std::set<std::string> own_flags_;
  std::size_t expected_ = 1;
  std::vector<StageResult> results_;
  std::vector<std::string> names_, warnings_, commands_;
  std::string error_, hint_;  // of the tool that runs
};

}  // namespace ngs::front
