#include "cut_summary.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iomanip>
#include <sstream>

#include "ngs/io/files/json_file.h"
#include "ngs/io/scene/scene_json.h"
#include "shared/run/sibling_program.h"

namespace ngs::front {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kShownWarnings = 3;

bool exists(const std::string& path) {
  std::error_code unreadable;
  return fs::exists(path, unreadable);
}

/// kind: "scores", or "agreement" without true masks; empty: neither.
struct Scores {
  std::string kind;
  nlohmann::json mean;
  std::size_t views = 0;
};

Scores scores_of(const CutChain& chain) {
  if (chain.flash()) return {};
  for (const auto& [kind, file] : {std::pair("scores", "metrics.json"), {"agreement", "agreement.json"}}) {
    if (!exists(chain.at(file))) continue;
    const nlohmann::json metrics = io::read_json_file(chain.at(file));
    return {kind, metrics.at("mean"), metrics.at("views").size()};
  }
  return {};
}

std::int64_t count_of(const CutChain& chain, const std::string& key) {
  if (const FlashFigures* flash = chain.written_by_flash()) return key == "object" ? flash->object : flash->background;
  const nlohmann::json& report = chain.stages().report("ngs-extract");
  return report.is_object() ? report.at("result").value(key, std::int64_t(-1)) : -1;
}

std::int64_t left_out_of(const CutChain& chain) {
  if (const FlashFigures* flash = chain.written_by_flash()) return flash->left_out;
  const nlohmann::json& report = chain.stages().report("ngs-extract");
  if (!report.is_object() || !report.at("result").contains("pieces")) return 0;
  return report.at("result").at("pieces").value("left_out", std::int64_t(0));
}

/// A warning if nearly all Gaussians are object, which is rarely intended.
std::string unusual_share(const CutChain& chain) {
  constexpr double kNearlyAll = 0.98;
  const double object = double(count_of(chain, "object")), all = object + double(count_of(chain, "background"));
  if (!(all > 0) || object <= kNearlyAll * all) return {};
  char share[80];
  std::snprintf(share, sizeof share, "%.1f %% of all Gaussians are object: is a background stroke missing?",
                100 * object / all);
  return share;
}

std::string score_line(const Scores& scores, bool has_truth) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(3) << "IoU " << scores.mean.value("iou", 0.0) << ", boundary IoU "
       << scores.mean.value("biou", 0.0) << " (wide) " << scores.mean.value("biou_005", 0.0) << " (narrow), "
       << scores.views << " views, "
       << (scores.kind == "agreement" ? "against the masks from your strokes, which are not ground truth"
           : has_truth                ? "against the true masks"
                                      : "against the input masks of the held-out views");
  return text.str();
}

std::string time_line(const CutChain& chain) {
  double total = 0;
  std::ostringstream parts;
  parts << std::fixed << std::setprecision(1);
  for (const StageResult& stage : chain.stages().results()) {
    total += stage.wall_s;
    parts << (parts.tellp() > 0 ? ", " : "") << stage.tool.substr(4) << " " << stage.wall_s;
  }
  if (chain.flash()) {
    total += chain.flash()->wall_s;
    parts << (parts.tellp() > 0 ? ", " : "") << "cut " << chain.flash()->wall_s;
  }
  std::ostringstream text;
  text << std::fixed << std::setprecision(1) << total << " s (" << parts.str() << ")"
       << (chain.reused_orbit() ? "; images reused from an earlier run" : "");
  return text.str();
}

void row(std::string& text, const std::string& name, const std::string& what) {
  text += name + std::string(name.size() < 12 ? 12 - name.size() : 1, ' ') + what + "\n";
}

std::string with_count(const std::string& path, std::int64_t count) {
  return path + (count < 0 ? "" : "  " + std::to_string(count) + " Gaussians");
}

}  // namespace

std::string summary_of(const CutChain& chain) {
  std::string text;
  row(text, "object", with_count(chain.at("object.ply"), count_of(chain, "object")));
  row(text, "background", with_count(chain.at("background.ply"), count_of(chain, "background")));
  row(text, "masks", chain.at("masks") + "/");
  if (chain.flash())
    row(text, "seen",
        std::to_string(chain.flash()->segmented) + " of " + std::to_string(chain.flash()->views) +
            " views were segmented; " + std::to_string(chain.flash()->in_ball) + " Gaussians in the ball");
  else
    row(text, "page", chain.at("report.html"));
  if (const std::int64_t left_out = left_out_of(chain); left_out > 0)
    row(text, "left out",
        std::to_string(left_out) + " Gaussians in components that no stroke touches; --all-pieces keeps them");
  if (chain.kept_untrained())
    row(text, "kept", "the untrained result, because the trained one agrees less with the strokes");
  if (const std::string unusual = unusual_share(chain); !unusual.empty()) row(text, "warning", unusual);
  if (const Scores scores = scores_of(chain); !scores.kind.empty())
    row(text, scores.kind, score_line(scores, !chain.inputs().truth.empty()));
  row(text, "time", time_line(chain));
  const std::vector<std::string>& warnings = chain.stages().warnings();
  for (std::size_t i = 0; i < std::min(kShownWarnings, warnings.size()); ++i) row(text, "warning", warnings[i]);
  const auto shown_end = warnings.begin() + std::ptrdiff_t(std::min(kShownWarnings, warnings.size()));
  if (std::any_of(warnings.begin(), shown_end, [&](const std::string& warning) {
        return chain.stages().names_flag_of_stage(warning.substr(warning.find(": ") + 2));
      }))
    row(text, "",
        "flags that ngs cut does not have belong to that tool: its command is in " + chain.at("reports") + "/");
  if (warnings.size() > kShownWarnings)
    row(text, "warning",
        std::to_string(warnings.size() - kShownWarnings) + " more warnings, in " + chain.at("reports") + "/");
  if (!chain.inputs().strokes.empty())
    row(text, "next",
        "where " + std::string(chain.flash() ? "a mask" : "the page") +
            " shows a wrong edge, draw strokes on that view too, add --strokes FILE and run again");
  return text;
}

std::string stroke_help(const CutChain& chain) {
  const Scene scene = io::read_scene_json(chain.inputs().kind == SourceKind::kSplat     ? chain.at("orbit/scene.json")
                                          : chain.inputs().kind == SourceKind::kCapture ? chain.at("capture.json")
                                                                                        : chain.inputs().source);
  const SceneView& first = scene.views.front();
  std::string text;
  row(text, "pictures",
      std::to_string(scene.views.size()) + " in " + fs::path(first.image_path).parent_path().string() + "/");
  if (chain.inputs().kind == SourceKind::kSplat)
    row(text, "", "if the images are not upright, give the upward axis, e.g. --up=-y, and run again");
  row(text, "mark", "paint the object green (0,255,0) and the background red (255,0,0) on copies of one or more");
  row(text, "", "images, as PNG with the same names, in another folder; or write strokes as JSON:");
  row(text, "",
      R"({"ngs_prompts": 1, "view": ")" + first.camera.name + R"(", "width": )" +
          std::to_string(first.camera.width_px) + R"(, "height": )" + std::to_string(first.camera.height_px) +
          R"(, "strokes": [)");
  row(text, "", R"(  {"object": true, "points": [[X, Y], [X, Y]]}, {"object": false, "points": [[X, Y], [X, Y]]}]})");
  std::vector<std::string> again{"ngs", "cut", chain.inputs().source, "-o", chain.inputs().out, "--strokes", "FILE"};
  for (const auto& [flag, path] : {std::pair("--model", chain.inputs().model),
                                   {"--images", chain.inputs().images},
                                   {"--world-transform", chain.inputs().world_transform}})
    if (!path.empty()) again.insert(again.end(), {flag, path});
  again.insert(again.end(), chain.inputs().all_words.begin(), chain.inputs().all_words.end());
  row(text, "next", cli::quoted_line(again));
  return text;
}

Json summary_json(const CutChain& chain) {
  const std::int64_t object = count_of(chain, "object"), background = count_of(chain, "background");
  Json json{{"object", chain.at("object.ply")},
            {"background", chain.at("background.ply")},
            {"masks", chain.at("masks")},
            {"object_gaussians", object},
            {"background_gaussians", background},
            {"left_out", left_out_of(chain)},
            {"kept_untrained", chain.kept_untrained()},
            {"reused_pictures", chain.reused_orbit()},
            {"stage_warnings", chain.stages().warnings()}};
  if (!chain.flash()) json["page"] = chain.at("report.html");
  if (chain.flash())
    json.update({{"in_ball", chain.flash()->in_ball},
                 {"views", chain.flash()->views},
                 {"segmented", chain.flash()->segmented},
                 {"cut_wall_s", chain.flash()->wall_s}});
  if (const Scores scores = scores_of(chain); !scores.kind.empty()) json[scores.kind] = Json(scores.mean);
  for (const StageResult& stage : chain.stages().results()) json["stage_wall_s"][stage.tool] = stage.wall_s;
  return json;
}

}  // namespace ngs::front
