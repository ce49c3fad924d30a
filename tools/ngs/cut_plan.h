#pragma once
// The one plan of ngs cut: its steps in their order, with the command of each. `ngs cut -n` prints it, CutChain runs it
// (run_step() has what happens in this process around a step), and tests/contract compares pipelines/ngs-gs.sh with it.
//
//   OUT/orbit/       a splat: scene.json and images/, the pictures that strokes are made on, and sheet.jpg, all of them
//   OUT/capture.json a capture: its cameras, photos and model
//   OUT/marked/      the marked views with their strokes
//   OUT/strokes/     masks from strokes, STEM.png
//   OUT/scene.json   the one that is cut: cameras, pictures and masks
//   OUT/groups/      --all: label maps with one id per object, their scene, and what is known of each object
//   OUT/labelled.ply object.ply background.ply masks/STEM.png agreement.json or metrics.json, report.html,
//                  object.html, mesh.glb
//
// With --method flash only orbit/, marked/, the models, masks/ and the pages (flash_cut.h).
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "cut_inputs.h"
#include "shared/progress/chain_clock.h"
#include "shared/run/run.h"

namespace ngs::ngs_tool {

using Words = std::vector<std::string>;

struct PlannedStep {
  std::string name;         // of its report
  std::string about;        // for people: "sharpening the edge"
  Words command;            // the tool and its arguments; empty: done in this process
  std::string files;        // what it writes, relative to the output folder
  double share = 1;         // expected time in seconds, of a small splat
  bool has_passes = false;  // its progress restarts
};

struct PlanFacts {
  bool marked = false;                  // there are strokes
  bool has_masks = false;               // of the scene, of the capture, or given
  bool reuses_pictures = false;         // of an earlier run
  std::optional<bool> one_object = {};  // known after ngs-group or ngs-extract
};

/// In the order in which they run. With only pictures, or nothing, to make: strokes or masks are missing.
std::vector<PlannedStep> planned_steps(const CutOptions& options, const CutInputs& inputs, const PlanFacts& facts);

/// A table of the steps: number, words, tool, files.
std::string plan_text(const std::vector<PlannedStep>& steps, const std::string& out);

/// "ngs-joint"; "ngs cut": in this process.
std::string tool_of(const PlannedStep& step);

/// The scene file with cameras and images, before masks are added.
std::string plain_scene(const CutOptions& options, const CutInputs& inputs);

/// ngs-extract that clips the object and fills the background of an untrained result.
Words mending_command(const CutOptions& options, const CutInputs& inputs);

// Runs other tools as the stages of one run and collects their reports.

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
  /// Sets the steps of the whole run, for the progress. As many steps again: only commands of later ones have changed.
  void plan(std::vector<PlannedStep> steps);
  const std::vector<PlannedStep>& steps() const { return steps_; }
  /// Begins a step that runs in this process; run() calls it for others. An unplanned step belongs to the current one.
  void begin(const std::string& name);

  const std::vector<StageResult>& results() const { return results_; }
  /// Report of the latest stage of this name; null if there is none.
  const nlohmann::json& report(const std::string& name) const;
  /// Warnings of all stages, as "ngs-mask: ...".
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// Command lines of the planned steps, without those of this process.
  Words commands() const;
  /// True if a stage's message mentions a flag that ngs cut does not have, unless it follows the name of a tool.
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
