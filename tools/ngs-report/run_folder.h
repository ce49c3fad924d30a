#pragma once
// Output of a run: OUT_DIR of pipelines/ngs-gs.sh, or any folder with some of the same files. Every file is optional
// and may be broken; read errors are listed in `problems`.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ngs/options/option_set.h"
#include "ngs/scene/scene.h"

namespace ngs::cli {

struct ToolReport {
  std::string name;  // file name without extension: "ngs-joint"
  Json report;
  std::string command = {};  // shell command line from NAME.sh; empty: unknown
};

/// One mask to show; the path of a missing file is empty.
struct ShownView {
  std::string view = {}, object = {};
  std::string photo = {}, predicted = {}, truth = {}, input = {};
  bool truth_is_input = false;  // no ground truth: scored against the input mask, which no stage has read
  Vec3<float> behind{0, 0, 0};  // colour behind a transparent photo: the scene's background
  std::uint32_t predicted_id = 0, truth_id = 0,
                input_id = 0;                  // 0: a mask; otherwise the object's id in a label map
  std::int64_t void_id = -1;                   // void id of the true label map; -1: none
  std::optional<std::size_t> scene_view = {};  // index in the scene; nullopt: unknown
  Json scores = {};                            // an entry of metrics.json "views", or null
};

struct RunFolder {
  std::string path, title;
  std::vector<ToolReport> reports;  // in the order of the chain
  std::optional<Scene> scene;
  Json metrics, metrics_input;
  std::vector<Json> trace;       // lines of trace.jsonl
  std::vector<ShownView> views;  // worst boundary IoU first
  std::vector<std::string> problems;

  const Json& report(std::string_view name) const;  // null without a report
  bool has_input_as_truth() const;                  // any ShownView::truth_is_input
};

/// Throws kBadInput if the folder contains no file of a run.
RunFolder read_run_folder(const std::string& path);

// Derived numbers of one or more runs.

/// Wall time of a run in seconds: sum over its tools' reports, without scoring.
double run_seconds(const RunFolder& run);
/// Option --method in the report of ngs-joint; an en dash without a report.
std::string method_of(const RunFolder& run);
/// Display name of the method: "COB-GS".
std::string method_title(const RunFolder& run);

std::string score_title(std::string_view name);  // "biou" -> "B-IoU 2&nbsp;%", HTML
/// Mean over the runs with this score; NaN if no run has it.
double mean_over_runs(const std::vector<RunFolder>& runs, std::string_view score);

}  // namespace ngs::cli
