#pragma once
// What a run left behind: OUT_DIR of pipelines/ngs-gs.sh, or any folder with some of the same files. Every
// file is optional and may be broken; what could not be read is said in `problems`.
#include <optional>
#include <string>
#include <vector>

#include "ngs/options/option_set.h"
#include "ngs/scene/scene.h"

namespace ngs::cli {

struct ToolReport {
  std::string name;  // of the file, "ngs-joint"
  Json report;
  std::string command = {};  // as for a shell, from the file of the same name with .sh; empty: not known
};

/// One mask to show; paths are empty where there is no such file.
struct ShownView {
  std::string view, object;
  std::string photo, predicted, truth, input;
  bool truth_is_input = false;  // no ground truth: the input mask, which no stage has read, stands in for it
  Vec3<float> behind{0, 0, 0};  // what a transparent photo shows: the scene's background
  std::uint32_t predicted_id = 0, truth_id = 0,
                input_id = 0;                  // 0: a mask; else the object's id in a label map
  std::int64_t void_id = -1;                   // of the truth, a label map; -1: none
  std::optional<std::size_t> scene_view = {};  // its index in the scene; none: not known
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

  const Json& report(std::string_view name) const;  // null where there is none
  bool has_stand_ins() const;                       // of some view, ShownView::truth_is_input
};

/// Throws kBadInput where the folder holds nothing of a run.
RunFolder read_run_folder(const std::string& path);

}  // namespace ngs::cli
