#include "cut_summary.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iomanip>
#include <map>
#include <sstream>

#include "ngs/core/formatted.h"
#include "ngs/core/listed.h"
#include "ngs/io/files/json_file.h"
#include "ngs/io/scene/scene_json.h"
#include "shared/run/child_process.h"
#include "shared/text/layout.h"

namespace ngs::ngs_tool {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kShownWarnings = 3;

/// kind: "scores", or "agreement" without true masks; empty: neither.
struct Scores {
  std::string kind;
  nlohmann::json mean;
  std::size_t views = 0;
  nlohmann::json alone;  // means of the object rendered alone; null: not scored
};

Scores scores_of(const CutChain& chain) {
  if (chain.flash()) return {};
  for (const auto& [kind, file] : {std::pair("scores", "metrics.json"), {"agreement", "agreement.json"}}) {
    if (!exists(chain.at(file))) continue;
    const nlohmann::json metrics = io::read_json_file(chain.at(file));
    return {kind, metrics.at("mean"), metrics.at("views").size(),
            metrics.contains("alone") ? metrics.at("alone").at("mean") : nlohmann::json()};
  }
  return {};
}

std::int64_t count_of(const CutChain& chain, const std::string& key) {
  if (const FlashFigures* flash = chain.written_by_flash()) return key == "object" ? flash->object : flash->background;
  const nlohmann::json& report = chain.stages().report("ngs-extract");
  return report.is_object() ? report.at("result").value(key, std::int64_t(-1)) : -1;
}

/// Gaussians of object.ply as written.
std::int64_t written_object(const CutChain& chain) {
  const nlohmann::json& report = chain.stages().report("ngs-extract");
  const std::int64_t count = count_of(chain, "object");
  if (!report.is_object() || !report.at("result").contains("finish")) return count;
  return report.at("result").at("finish").value("object", count);
}

/// `key`: left_out or needles.
std::int64_t pieces_of(const CutChain& chain, const std::string& key) {
  if (const FlashFigures* flash = chain.written_by_flash()) return key == "needles" ? flash->needles : flash->left_out;
  const nlohmann::json& report = chain.stages().report("ngs-extract");
  if (!report.is_object() || !report.at("result").contains("pieces")) return 0;
  return report.at("result").at("pieces").value(key, std::int64_t(0));
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

/// What the result was compared with.
std::string reference_words(const CutChain& chain, const Scores& scores) {
  if (scores.kind == "agreement") return "the masks from your strokes, which are not ground truth";
  const std::string& truth = chain.inputs().truth;
  if (truth.empty()) return "the input masks of the held-out views";
  for (const SceneView& view : io::read_scene_json(chain.at("scene.json")).views) {
    std::error_code unknown;
    if (!view.mask_path.empty() && fs::equivalent(fs::path(view.mask_path).parent_path(), truth, unknown))
      return "the input masks, which --gt names too: this is agreement, not accuracy";
  }
  return "the true masks";
}

std::string score_line(const CutChain& chain, const Scores& scores) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(3) << "IoU " << scores.mean.value("iou", 0.0) << ", boundary IoU "
       << scores.mean.value("biou", 0.0) << " (wide) " << scores.mean.value("biou_005", 0.0) << " (narrow), "
       << scores.views << " views, against " << reference_words(chain, scores);
  if (!scores.alone.is_null())
    text << "; object.ply rendered alone: IoU " << scores.alone.value("iou", 0.0) << ", "
         << scores.alone.value("biou_005", 0.0) << " (narrow)";
  return text.str();
}

/// Wall seconds by tool; a tool may run several times.
std::map<std::string, double> stage_times(const CutChain& chain) {
  std::map<std::string, double> times;
  for (const StageResult& stage : chain.stages().results()) times[stage.tool] += stage.wall_s;
  return times;
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
  text += cli::padded(name, 12) + what + "\n";
}

std::string with_count(const std::string& path, std::int64_t count) {
  return path + (count < 0 ? "" : "  " + std::to_string(count) + " Gaussians");
}

/// What ngs-extract clipped and filled, or why it filled nothing.
void add_mending(std::string& text, const CutChain& chain) {
  const nlohmann::json& report = chain.stages().report("ngs-extract");
  if (!report.is_object()) return;
  const nlohmann::json& result = report.at("result");
  if (result.contains("fill")) {
    const nlohmann::json& fill = result.at("fill");
    row(text, "filled",
        (fill.contains("nothing") ? "nothing: " + fill.at("nothing").get<std::string>()
                                  : chain.at("background-filled.ply") + "  " + fill.at("rows_added").dump() +
                                        " Gaussians added where the object stood, invented") +
            "; " + fill.at("coverage").get<std::string>());
  }
  if (result.contains("finish"))
    row(text, "clipped",
        result.at("finish").at("clipped").dump() + " Gaussians of object.ply, " +
            result.at("finish").at("dropped").dump() + " left out; --no-finish keeps them");
}

/// ", 8 convex parts that add 16.8 % to its volume"; empty without colliders.
std::string collider_words(const CutChain& chain) {
  const nlohmann::json& report = chain.stages().report("ngs-mesh");
  if (!report.is_object() || !report.at("result").contains("collider")) return {};
  const nlohmann::json& collider = report.at("result").at("collider");
  return "  " + collider.at("parts").dump() + " convex parts, which add " +
         formatted("%.1f", 100 * collider.at("outside_share").get<double>()) + " % to its volume";
}

/// The objects in object.ply, if there are several, and the command for one of them.
void add_objects(std::string& text, const CutChain& chain) {
  constexpr std::size_t kShown = 6;
  const nlohmann::json& report = chain.stages().report("ngs-extract");
  if (!report.is_object() || chain.written_by_flash()) return;
  const nlohmann::json& objects = report.at("result").at("objects");
  if (objects.size() < 2) return;
  std::string counts;
  for (std::size_t k = 0; k < std::min(kShown, objects.size()); ++k)
    counts += (k > 0 ? ", " : "") + objects[k].at("name").get<std::string>() + " " +
              std::to_string(objects[k].at("object").get<std::int64_t>());
  if (objects.size() > kShown) counts += " and " + std::to_string(objects.size() - kShown) + " more";
  row(text, "objects", counts);
  const std::string name = objects[0].at("name");
  row(text, "",
      "one alone: " + cli::quoted_line({"ngs-extract", chain.at("labelled.ply"), "--object", name, "--object-ply",
                                        chain.at("object-" + name + ".ply")}));
}

/// Views from whose masks the object was not cut, though the others have some; empty with strokes.
std::vector<std::string> views_without_mask(const CutChain& chain) {
  std::vector<std::string> names;
  if (!chain.inputs().strokes.empty()) return names;
  for (const SceneView& view : io::read_scene_json(chain.at("scene.json")).views)
    if (view.mask_path.empty()) names.push_back(view.camera.name);
  return names;
}

}  // namespace

std::string summary_of(const CutChain& chain) {
  std::string text;
  row(text, "object", with_count(chain.at("object.ply"), written_object(chain)));
  add_objects(text, chain);
  row(text, "background", with_count(chain.at("background.ply"), count_of(chain, "background")));
  for (const std::string& format : chain.formats())
    row(text, format, chain.at("object." + format) + ", " + chain.at("background." + format));
  add_mending(text, chain);
  if (chain.writes_mesh()) row(text, "mesh", chain.at("mesh.glb") + collider_words(chain));
  row(text, "masks", chain.at("masks") + "/");
  if (const std::vector<std::string> unused = views_without_mask(chain); !unused.empty())
    row(text, "left out", "no mask is used of " + std::to_string(unused.size()) + " views: " + listed(unused, 4));
  row(text, "page", chain.at("report.html"));
  if (exists(chain.at("object.html"))) row(text, "3D", chain.at("object.html"));
  if (chain.flash())
    row(text, "seen",
        std::to_string(chain.flash()->segmented) + " of " + std::to_string(chain.flash()->views) +
            " views were segmented; " + std::to_string(chain.flash()->in_ball) + " Gaussians in the ball");
  if (const std::int64_t needles = pieces_of(chain, "needles"); needles > 0)
    row(text, "trimmed",
        std::to_string(needles) + " long thin Gaussians that stuck out of the object where it was cut");
  if (const std::int64_t left_out = pieces_of(chain, "left_out"); left_out > 0)
    row(text, "left out",
        std::to_string(left_out) + " Gaussians in components that no stroke touches; --all-pieces keeps them");
  if (chain.kept_untrained())
    row(text, "kept", "the untrained result, because the trained one agrees less with the strokes or between views");
  if (const std::string unusual = unusual_share(chain); !unusual.empty()) row(text, "warning", unusual);
  if (const std::string apart = chain.agreement().text(); !apart.empty()) row(text, "warning", apart);
  if (chain.agreement().covers_borders && !chain.inputs().strokes.empty())
    row(text, "warning",
        "the result covers most of the pictures' borders: if it is the background, exchange the strokes of object and "
        "background (true and false, or green and red)");
  if (const Scores scores = scores_of(chain); !scores.kind.empty()) row(text, scores.kind, score_line(chain, scores));
  if (!chain.not_scored().empty()) row(text, "not scored", chain.not_scored());
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
        "where the page shows a wrong edge, draw strokes on that view too, add --strokes FILE and run again");
  return text;
}

std::string all_text(const CutChain& chain) {
  const Json found = Json(io::read_json_file(chain.at("objects.json")));
  std::string text;
  row(text, "objects",
      std::to_string(found.at("objects").size()) + " in " + chain.at("objects") + "/, largest first; " +
          chain.at("objects.json"));
  if (const std::size_t doubtful = found.at("doubtful").size(); doubtful > 0)
    row(text, "doubtful", std::to_string(doubtful) + " more are too small, seen too rarely or uncertain: not written");
  row(text, "background", with_count(chain.at("background.ply"), count_of(chain, "background")));
  row(text, "masks", chain.at("masks") + "/, one id per object in all views");
  row(text, "page", chain.at("report.html"));
  row(text, "time", time_line(chain));
  const std::vector<std::string>& warnings = chain.stages().warnings();
  for (std::size_t i = 0; i < std::min(kShownWarnings, warnings.size()); ++i) row(text, "warning", warnings[i]);
  return text;
}

Json all_json(const CutChain& chain) {
  const Json found = Json(io::read_json_file(chain.at("objects.json")));
  Json json{{"objects", found.at("objects").size()},
            {"doubtful", found.at("doubtful").size()},
            {"objects_folder", chain.at("objects")},
            {"background", chain.at("background.ply")},
            {"masks", chain.at("masks")},
            {"page", chain.at("report.html")},
            {"stage_warnings", chain.stages().warnings()}};
  json["stage_wall_s"] = stage_times(chain);
  return json;
}

StrokeHelp stroke_help(const CutChain& chain) {
  const Scene scene = io::read_scene_json(chain.plain_scene());
  const Camera& first = scene.views.front().camera;
  const std::vector<std::string>& warnings = chain.stages().warnings();
  StrokeHelp help;
  for (std::size_t i = 0; i < std::min(kShownWarnings, warnings.size()); ++i) row(help.text, "warning", warnings[i]);
  row(help.text, "pictures",
      std::to_string(scene.views.size()) + " in " +
          fs::path(scene.views.front().image_path).parent_path().generic_string() + "/");
  if (chain.inputs().kind == SourceKind::kSplat) {
    if (exists(chain.at("orbit/sheet.jpg")))
      row(help.text, "sheet", chain.at("orbit/sheet.jpg") + " shows all of them");
    if (!chain.inputs().renders_capture)
      row(help.text, "", "if the pictures are not upright, give the upward axis, e.g. --up=-y, and run again");
  }
  row(help.text, "mark",
      "paint the object green (0,255,0) and the background red (255,0,0) on copies of one or more pictures, as PNG "
      "with the same names, in another folder");
  row(help.text, "or", "write strokes as JSON, in pixels:");
  const int w = first.width_px, h = first.height_px;
  const auto point = [](int x, int y) { return "[" + std::to_string(x) + ", " + std::to_string(y) + "]"; };
  help.sample =
      R"({"ngs_prompts": 1, "view": )" + Json(first.name).dump(-1, ' ', false, Json::error_handler_t::replace) +
      R"(, "width": )" + std::to_string(w) + R"(, "height": )" + std::to_string(h) +
      R"(, "strokes": [{"object": true, "points": [)" + point(w / 2, h / 2) + ", " + point(w / 2, h / 2 + h / 8) +
      R"(]}, {"object": false, "points": [)" + point(w / 20, h / 20) + ", " + point(w - w / 20, h / 20) + "]}]}\n";
  return help;
}

std::string next_line(const CutChain& chain, const std::vector<std::string>& further) {
  std::vector<std::string> again{"ngs", "cut", chain.inputs().source, "-o", chain.inputs().out};
  for (const std::string& strokes : chain.inputs().strokes) again.insert(again.end(), {"--strokes", strokes});
  for (const auto& [flag, path] : {std::pair("--model", chain.inputs().model),
                                   {"--images", chain.inputs().images},
                                   {"--world-transform", chain.inputs().world_transform},
                                   {"--masks", chain.inputs().given_masks},
                                   {"--gt", chain.inputs().given_truth}})
    if (!path.empty()) again.insert(again.end(), {flag, path});
  again.insert(again.end(), further.begin(), further.end());
  again.insert(again.end(), chain.inputs().all_words.begin(), chain.inputs().all_words.end());
  std::string text;
  row(text, "next", cli::quoted_line(again));
  return text;
}

std::string stopped_text(const CutChain& chain) {
  std::string kept;
  for (const auto& [name, what] :
       {std::pair("orbit/made_from.json", "pictures in orbit/images/"),
        {"capture.json", "capture.json"},
        {"strokes", "masks in strokes/"},
        {"object.ply", chain.stages().report("ngs-extract").is_null() ? "object.ply of an earlier run" : "object.ply"}})
    if (exists(chain.at(name))) kept += (kept.empty() ? "" : ", ") + std::string(what);
  std::string text;
  row(text, "stopped", kept.empty() ? "nothing was finished" : "kept in " + chain.inputs().out + "/: " + kept);
  if (exists(chain.at("orbit/made_from.json")))
    row(text, "", "the pictures are used again, so that your strokes on them stay valid");
  return text;
}

Json summary_json(const CutChain& chain) {
  const std::int64_t object = count_of(chain, "object"), background = count_of(chain, "background");
  Json json{{"object", chain.at("object.ply")},
            {"background", chain.at("background.ply")},
            {"masks", chain.at("masks")},
            {"object_gaussians", object},
            {"background_gaussians", background},
            {"left_out", pieces_of(chain, "left_out")},
            {"not_scored", chain.not_scored()},
            {"kept_untrained", chain.kept_untrained()},
            {"reused_pictures", chain.reused_orbit()},
            {"views_without_mask", views_without_mask(chain)},
            {"stage_warnings", chain.stages().warnings()}};
  json["page"] = chain.at("report.html");
  if (chain.writes_mesh()) json["mesh"] = chain.at("mesh.glb");
  if (const ResultAgreement& found = chain.agreement(); found.masks > 0)
    json["mask_agreement"] = {{"masks", found.masks},
                              {"median", found.median},
                              {"apart", found.apart},
                              {"covers_borders", found.covers_borders}};
  if (exists(chain.at("object.html"))) json["page_3d"] = chain.at("object.html");
  if (chain.flash())
    json.update({{"in_ball", chain.flash()->in_ball},
                 {"views", chain.flash()->views},
                 {"segmented", chain.flash()->segmented},
                 {"cut_wall_s", chain.flash()->wall_s}});
  if (const Scores scores = scores_of(chain); !scores.kind.empty()) json[scores.kind] = Json(scores.mean);
  json["stage_wall_s"] = stage_times(chain);
  return json;
}

}  // namespace ngs::ngs_tool
