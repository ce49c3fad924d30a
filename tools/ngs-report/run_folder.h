#pragma once
// Output of a run: OUT_DIR of pipelines/ngs-gs.sh, or any folder with some of the same files. Every file is optional
// and may be broken; read errors are listed in `problems`.
#include <optional>
#include <string>
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
  std::string view, object;
  std::string photo, predicted, truth, input;
  bool truth_is_input = false;  // no ground truth: scored against the input mask, which no stage has read
  Vec3<float> behind{0, 0, 0};  // colour behind a transparent photo: the scene's background
  std::uint32_t predicted_id = 0, truth_id = 0,
                input_id = 0;                  // 0: a mask; otherwise the object's id in a label map
  std::int64_t void_id = -1;                   // void id of the true label map; -1: none
  std::optional<std::size_t> scene_view = {};  // index in the scene; nullopt: unknown
  Json scores;                                 // an entry of metrics.json "views", or null
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

}  // namespace ngs::cli
