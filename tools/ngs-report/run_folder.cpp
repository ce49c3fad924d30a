#include "run_folder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <utility>

#include "ngs/core/error.h"
#include "ngs/io/files/match_names.h"
#include "ngs/io/image/annotations.h"
#include "ngs/io/image/masks.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/scene/view_names.h"
#include "shared/page/html.h"

namespace ngs::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestJsonBytes = 256u << 20;

std::string read_text(const fs::path& path) {
  if (fs::file_size(path) > kLargestJsonBytes)
    throw Error(ErrorCode::kBadInput, path.generic_string() + ": larger than 256 MiB, expected a report");
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) throw Error(ErrorCode::kBadInput, path.generic_string() + ": cannot be read");
  return text.str();
}

/// Runs `read` if the file exists; a failure is added to the problems of the run.
template <class Read>
void if_present(RunFolder& run, const fs::path& path, const Read& read) {
  if (!fs::is_regular_file(path)) return;
  try {
    read();
  } catch (const std::exception& e) {
    run.problems.push_back(e.what());
  }
}

int chain_position(std::string_view name) {
  constexpr std::array kChain = {"ngs-synth", "ngs-fit",     "ngs-scene",  "ngs-variance",   "ngs-sample", "ngs-rbf",
                                 "ngs-joint", "ngs-extract", "ngs-render", "ngs-eval-input", "ngs-eval"};
  return int(std::find(kChain.begin(), kChain.end(), name) - kChain.begin());
}

void read_reports(RunFolder& run) {
  const fs::path folder = fs::path(run.path) / "reports";
  if (!fs::is_directory(folder)) return;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().stem().string();
    if (entry.path().extension() != ".json" || name == "ngs-report") continue;
    if_present(run, entry.path(), [&] {
      Json report = parse_json(read_text(entry.path()), entry.path().generic_string());
      if (!report.is_object())
        throw Error(ErrorCode::kBadInput, entry.path().generic_string() + ": expected a JSON object");
      const fs::path command = folder / (name + ".sh");
      run.reports.push_back(
          {name, std::move(report), fs::is_regular_file(command) ? read_text(command) : std::string()});
    });
  }
  std::sort(run.reports.begin(), run.reports.end(), [](const ToolReport& a, const ToolReport& b) {
    return std::pair(chain_position(a.name), a.name) < std::pair(chain_position(b.name), b.name);
  });
}

void read_trace(RunFolder& run, const fs::path& path) {
  std::istringstream text(read_text(path));
  for (std::string line; std::getline(text, line);)
    if (!line.empty()) run.trace.push_back(parse_json(line, path.generic_string()));
}

/// Resolves a path in a report, relative to the run folder or to the working directory.
std::string found_path(const RunFolder& run, const std::string& path) {
  if (path.empty()) return {};
  std::error_code ignored;
  for (const fs::path& candidate : {fs::path(run.path) / path, fs::path(path)})
    if (fs::is_regular_file(candidate, ignored)) return candidate.generic_string();
  return {};
}

std::string text_at(const Json& json, std::string_view key) {
  const Json& value = value_at(json, {key});
  return value.is_string() ? value.get<std::string>() : std::string();
}

std::uint32_t count_at(const Json& json, std::string_view key) {
  const Json& value = value_at(json, {key});
  return value.is_number_unsigned() ? value.get<std::uint32_t>() : 0;
}

/// Of ngs-eval; without scores against true masks, of its comparison with the masks from strokes.
const Json& scoring_report(const RunFolder& run) {
  const Json& scores = run.report("ngs-eval");
  return scores.is_null() ? run.report("ngs-eval-agreement") : scores;
}

/// Id of an object in the label maps that ngs-eval read; 0 for masks.
std::uint32_t label_id(const RunFolder& run, const std::string& object) {
  const Json& options = value_at(scoring_report(run), {"options"});
  if (value_at(options, {"label_map"}) != Json(true)) return 0;
  for (const Json& entry : value_at(options, {"object_id"})) {
    const std::string text = entry.is_string() ? entry.get<std::string>() : std::string();
    if (text.size() > object.size() && text.starts_with(object) && text[object.size()] == '=')
      return std::uint32_t(std::strtoul(text.c_str() + object.size() + 1, nullptr, 10));
  }
  return std::uint32_t(std::strtoul(object.c_str(), nullptr, 10));
}

/// Adds scored views: files from the report of ngs-eval, scores from metrics.json.
void add_scored_views(RunFolder& run) {
  std::map<std::pair<std::string, std::string>, const Json*> files;
  for (const Json& file : value_at(scoring_report(run), {"result", "files"}))
    files[{text_at(file, "view"), text_at(file, "object")}] = &file;
  for (const Json& scores : value_at(run.metrics, {"views"})) {
    ShownView view{.view = text_at(scores, "view"), .object = text_at(scores, "object"), .scores = scores};
    auto file = files.find({view.view, view.object});
    if (file == files.end()) file = files.find({view.view, ""});
    if (file != files.end()) {
      view.predicted = found_path(run, text_at(*file->second, "predicted"));
      view.truth = found_path(run, text_at(*file->second, "truth"));
      view.truth_id = count_at(*file->second, "truth_id");
      const Json& void_id = value_at(scoring_report(run), {"options", "void_id"});
      if (void_id.is_number_integer()) view.void_id = void_id.get<std::int64_t>();
      if (view.truth_id == 0) view.truth_id = view.predicted_id = label_id(run, view.object);
    }
    run.views.push_back(std::move(view));
  }
  std::stable_sort(run.views.begin(), run.views.end(), [](const ShownView& a, const ShownView& b) {
    const auto key = [](const ShownView& v) {
      return value_at(v.scores, {"biou"}).is_number() ? number_at(v.scores, {"biou"}) : -1;
    };
    return key(a) < key(b);
  });
}

/// Without scores, adds the rendered masks.
void add_rendered_views(RunFolder& run) {
  const fs::path folder = fs::path(run.path) / "masks";
  if (!run.views.empty() || !fs::is_directory(folder)) return;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".png")
      run.views.push_back({.view = image_stem(entry.path().lexically_relative(folder).generic_string()),
                           .predicted = entry.path().generic_string()});
  std::sort(run.views.begin(), run.views.end(), [](const ShownView& a, const ShownView& b) { return a.view < b.view; });
}

void add_scene_files(RunFolder& run) {
  if (!run.scene) return;
  std::vector<std::string> known;
  for (const SceneView& view : run.scene->views) known.push_back(view.camera.name);
  const ViewNames names(run.scene->views);
  for (ShownView& view : run.views) {
    std::vector<std::size_t> found = names.find(view.view);
    if (found.size() != 1) {
      const std::vector<std::string> one{view.view};
      const io::NameMatch match = io::match_names(one, known);
      if (match.pairs.empty()) continue;
      found = {match.pairs[0].truth};
    }
    std::error_code ignored;
    view.scene_view = found[0];
    const SceneView& camera = run.scene->views[found[0]];
    if (fs::is_regular_file(camera.image_path, ignored)) view.photo = camera.image_path;
    view.behind = background_of(*run.scene);
    const std::vector<std::string> masks = io::mask_files(*run.scene, found[0]);
    for (std::size_t k = 0; k < masks.size(); ++k)
      if ((masks.size() == 1 || run.scene->objects[k].name == view.object) && fs::is_regular_file(masks[k], ignored) &&
          !io::is_annotations(masks[k]))
        view.input = masks[k];
    view.truth_is_input = !view.truth.empty() && !view.input.empty() && fs::equivalent(view.truth, view.input, ignored);
    for (const SceneObject& object : run.scene->objects)
      if (run.scene->mask_mode == MaskMode::kLabel && (run.scene->objects.size() == 1 || object.name == view.object))
        view.input_id = object.id;
  }
}

}  // namespace

const Json& RunFolder::report(std::string_view name) const {
  static const Json nothing;
  for (const ToolReport& tool : reports)
    if (tool.name == name) return tool.report;
  return nothing;
}

bool RunFolder::has_input_as_truth() const {
  return std::ranges::any_of(views, [](const ShownView& view) { return view.truth_is_input; });
}

RunFolder read_run_folder(const std::string& path) {
  if (!fs::is_directory(path))
    throw Error(ErrorCode::kBadInput, path + ": no such folder, expected the output of pipelines/ngs-gs.sh");
  RunFolder run;
  run.path = path;
  run.title = fs::weakly_canonical(path).filename().string();
  const fs::path folder(path);
  read_reports(run);
  if_present(run, folder / "scene.json",
             [&] { run.scene = io::read_scene_json((folder / "scene.json").generic_string()); });
  const auto metrics = [&](const char* name, Json& json) {
    if_present(run, folder / name,
               [&] { json = parse_json(read_text(folder / name), (folder / name).generic_string()); });
  };
  metrics("metrics.json", run.metrics);
  if (run.metrics.is_null()) metrics("agreement.json", run.metrics);  // of ngs cut: against the masks from strokes
  metrics("metrics_input.json", run.metrics_input);
  if_present(run, folder / "trace.jsonl", [&] { read_trace(run, folder / "trace.jsonl"); });
  if (run.reports.empty() && !run.scene && run.metrics.is_null())
    throw Error(ErrorCode::kBadInput,
                path + ": no reports/*.json, scene.json or metrics.json, expected the output of a run",
                "make one with pipelines/ngs-gs.sh SCENE_DIR " + path);
  add_scored_views(run);
  add_rendered_views(run);
  add_scene_files(run);
  return run;
}

double run_seconds(const RunFolder& run) {
  double seconds = 0;
  for (const ToolReport& tool : run.reports) {
    const double wall = number_at(tool.report, {"stages", "wall_s"});
    if (std::isfinite(wall) && !tool.name.starts_with("ngs-eval")) seconds += wall;
  }
  return seconds;
}

std::string method_of(const RunFolder& run) {
  const Json& method = value_at(run.report("ngs-joint"), {"options", "method"});
  return method.is_string() && !method.get<std::string>().empty() ? method.get<std::string>() : "–";
}

std::string method_title(const RunFolder& run) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kTitles = {
      {{"ngs", "NGS"},
       {"ng-gs", "NG-GS"},
       {"flash", "FlashSplat"},
       {"cob", "COB-GS"},
       {"sa3d", "SA3D-GS"},
       {"saga", "SAGA"},
       {"released", "published NG-GS code"},
       {"bce", "cross-entropy of masks"}}};
  std::string name = method_of(run);
  for (const auto& [key, title] : kTitles)
    if (key == name) return std::string(title);
  return name;
}

std::string score_title(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 9> kTitles = {
      {{"iou", "IoU"},
       {"accuracy", "accuracy"},
       {"class_accuracy", "class accuracy"},
       {"biou", "B-IoU 2&nbsp;%"},
       {"biou_005", "B-IoU 0.5&nbsp;%"},
       {"biou_1px", "B-IoU 1&nbsp;px"},
       {"biou_3px", "B-IoU 3&nbsp;px"},
       {"biou_5px", "B-IoU 5&nbsp;px"},
       {"contour_f", "contour F"}}};
  for (const auto& [key, title] : kTitles)
    if (key == name) return std::string(title);
  return escaped(name);
}

double mean_over_runs(const std::vector<RunFolder>& runs, std::string_view score) {
  double sum = 0;
  int count = 0;
  for (const RunFolder& run : runs) {
    const double value = number_at(run.metrics, {"mean", score});
    if (std::isfinite(value)) {
      sum += value;
      ++count;
    }
  }
  return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace ngs::cli
