#include "sections.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "charts.h"
#include "ngs/core/error.h"
#include "ngs/io/ply/ply.h"
#include "ngs/ops/image/metrics.h"
#include "shared/page/html.h"

namespace ngs::cli {
namespace {

void add_tile(std::string& html, const std::string& name, const std::string& value, const std::string& note = {}) {
  html +=
      "<div><dt>" + name + "</dt><dd>" + value + (note.empty() ? "" : "<small>" + note + "</small>") + "</dd></div>";
}

/// Reference of the scores without ground truth.
constexpr const char* kInputAsTruth = "input masks, no ground truth";

std::string reference_note(const RunFolder& run, std::string_view score) {
  if (run.has_input_as_truth()) return std::string("against ") + kInputAsTruth + ", which may be wrong";
  const double input = number_at(run.metrics_input, {"mean", score});
  return std::isfinite(input) ? "input masks " + decimal(input, 3) : std::string();
}

std::vector<std::string> score_row(const std::string& name, const Json& mean) {
  std::vector<std::string> row{name};
  for (std::string_view score : kScoreNames) row.push_back(decimal(number_at(mean, {score}), 4));
  return row;
}

std::vector<std::string> score_head(const std::string& first) {
  std::vector<std::string> head{first};
  for (std::string_view score : kScoreNames) head.push_back(score_title(score));
  return head;
}

std::string legend(const char* truth, bool input) {
  const auto entry = [](const char* kind, const char* name) {
    return std::string("<label><input type=checkbox checked class=t-") + kind +
           "><svg aria-hidden=true viewBox=\"0 0 38 16\"><g class=" + kind +
           "><path class=casing d=\"M3 8h32\"/><path d=\"M3 8h32\"/></g></svg>" + name + "</label>";
  };
  return "<div class=legend>" + entry("predicted", "prediction") + (truth[0] != 0 ? entry("truth", truth) : "") +
         (input ? entry("input", "input mask") : "") + "</div>";
}

/// Rows of a splat of the run, from its header; -1: none.
std::int64_t gaussians_in(const RunFolder& run, const char* file) {
  const std::filesystem::path path = std::filesystem::path(run.path) / file;
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(path, unreadable)) return -1;
  try {
    const io::PlyFile ply = io::PlyFile::header_of(path.generic_string());
    const io::PlyElement* rows = ply.find("vertex");
    return rows == nullptr ? -1 : std::int64_t(rows->count);
  } catch (const Error&) {  // overview_section() reports it
    return -1;
  }
}

std::string share_of(std::int64_t part, std::int64_t all) {
  return all > 0 ? "; " + decimal(100 * double(part) / double(all), 1) + " % are object" : std::string();
}

double seconds_of(const Json& stage) { return number_at(stage, {"wall_s"}); }

std::string rate(double per_second) {
  return per_second >= 100 && per_second < 1e15 ? with_separators(std::llround(per_second)) : decimal(per_second, 1);
}

std::string bar_row(const char* row_class, const std::string& name, const Json& stage, double largest) {
  const Json& items = value_at(stage, {"items"});
  std::string row = std::string("<tr class=") + row_class + "><th scope=row>" + escaped(name) + "</th><td>" +
                    bar_svg(seconds_of(stage), largest) + "</td><td>" + duration(seconds_of(stage)) + "</td><td>";
  if (items.is_number_integer() && items.get<std::int64_t>() > 0)
    row += with_separators(items.get<std::int64_t>()) + " items, " + rate(number_at(stage, {"items_per_s"})) + "/s";
  return row + "</td><td>" + decimal(number_at(stage, {"max_rss_mib"}), 0) + " MiB</td></tr>";
}

const Json& list_at(const Json& json, std::initializer_list<std::string_view> keys) {
  static const Json empty = Json::array();
  const Json& value = value_at(json, keys);
  return value.is_array() ? value : empty;
}

/// True if the result was made from a mask of this view, which biases its scores.
bool is_training_view(const SceneView& view) { return view.split == Split::kTrain && !view.mask_path.empty(); }

/// "3 of 7 NOUN were used in training" if training views are scored against ground truth, otherwise empty.
std::string training_note(const RunFolder& run, const std::string& noun) {
  if (run.has_input_as_truth()) return {};  // no accuracy anyway, and named so
  std::set<std::string> scored, training;
  for (const ShownView& view : run.views) {
    if (view.scores.is_null()) continue;
    scored.insert(view.view);
    if (view.scene_view && is_training_view(run.scene->views[*view.scene_view])) training.insert(view.view);
  }
  if (training.empty()) return {};
  return with_separators(std::int64_t(training.size())) + " of " + with_separators(std::int64_t(scored.size())) + " " +
         noun + " were used in training";
}

/// What ngs-extract clipped and filled, or why it filled nothing.
void add_mending_tiles(const RunFolder& run, std::string& html) {
  const Json& result = value_at(run.report("ngs-extract"), {"result"});
  if (const Json& finish = value_at(result, {"finish"}); !finish.is_null())
    add_tile(html, "object.ply", decimal(number_at(finish, {"clipped"}), 0) + " clipped",
             decimal(number_at(finish, {"dropped"}), 0) + " left out: Gaussians that reach out of the masks");
  if (const Json& fill = value_at(result, {"fill"}); !fill.is_null())
    add_tile(html, "background-filled.ply", decimal(number_at(fill, {"rows_added"}), 0) + " added",
             (fill.contains("nothing") ? "nothing filled: " + escaped(json_text(value_at(fill, {"nothing"})))
                                       : "invented Gaussians where the object stood") +
                 "; " + escaped(json_text(value_at(fill, {"coverage"}))));
}

}  // namespace

std::string tiles(const RunFolder& run) {
  std::string html = "<dl class=tiles>";
  for (const auto& [score, name] : {std::pair{"iou", "IoU"}, {"biou", "boundary IoU"}, {"accuracy", "accuracy"}})
    if (std::isfinite(number_at(run.metrics, {"mean", score})))
      add_tile(html, name, decimal(number_at(run.metrics, {"mean", score}), 3), reference_note(run, score));
  if (const double psnr = number_at(run.metrics, {"mean", "psnr_db"}); std::isfinite(psnr))
    add_tile(html, "PSNR", decimal(psnr, 2) + " dB", "SSIM " + decimal(number_at(run.metrics, {"mean", "ssim"}), 3));
  if (!run.report("ngs-joint").is_null()) {
    const Json& quality = value_at(run.report("ngs-joint"), {"options", "quality"});
    const std::string name = "--method " + escaped(method_of(run));
    add_tile(html, "method", escaped(method_title(run)),
             quality.is_string() ? name + ", --quality " + escaped(quality.get<std::string>()) : name);
  }
  if (const std::int64_t object = gaussians_in(run, "object.ply"), rest = gaussians_in(run, "background.ply");
      object >= 0)
    add_tile(html, "Gaussians of the object", with_separators(object),
             rest < 0 ? "" : with_separators(rest) + " of the background" + share_of(object, object + rest));
  add_mending_tiles(run, html);
  if (run_seconds(run) > 0) add_tile(html, "time", duration(run_seconds(run)), "whole chain without scoring");
  if (run.scene) {
    const auto held_out = std::count_if(run.scene->views.begin(), run.scene->views.end(),
                                        [](const SceneView& view) { return view.split == Split::kHeldOut; });
    const std::string training = training_note(run, "scored");
    add_tile(html, "views", with_separators(std::int64_t(run.scene->views.size())),
             with_separators(held_out) + " held out" + (training.empty() ? "" : ", " + training));
  }
  return html + "</dl>\n";
}

std::string warnings_section(const RunFolder& run) {
  std::string list;
  if (const std::string training = training_note(run, "scored views"); !training.empty())
    list += "<li><b>scores</b> " + training + ": these scores are biased, use held-out views</li>";
  for (const std::string& problem : run.problems) list += "<li><b>report</b> " + escaped(problem) + "</li>";
  for (const ToolReport& tool : run.reports) {
    for (const Json& warning : list_at(tool.report, {"warnings"}))
      list += "<li><b>" + escaped(tool.name) + "</b> " + escaped(json_text(warning)) + "</li>";
    const double code = number_at(tool.report, {"exit_code"});
    if (code == 1) list += "<li><b>" + escaped(tool.name) + "</b> a requested check failed</li>";
    if (code == 7) list += "<li><b>" + escaped(tool.name) + "</b> time budget used up; the result is partial</li>";
  }
  return list.empty() ? list : section("warnings", "Warnings", "<ul class=odd>" + list + "</ul>");
}

std::string accuracy_section(const RunFolder& run) {
  if (value_at(run.metrics, {"mean"}).is_null() || value_at(run.metrics, {"kind"}) == Json("photos")) return {};
  Table table{.caption = std::string("Mean over the scored views") +
                         (run.has_input_as_truth() ? std::string(", against ") + kInputAsTruth : "") +
                         "; boundary IoU by band width (share of the diagonal, or px)",
              .head = score_head("masks")};
  if (!run.metrics_input.is_null())
    table.rows.push_back(score_row("input masks, same views", value_at(run.metrics_input, {"mean"})));
  table.rows.push_back(
      score_row(run.report("ngs-joint").is_null() ? "predicted masks" : escaped(method_title(run)) + ", rendered",
                value_at(run.metrics, {"mean"})));
  if (const Json& alone = value_at(run.metrics, {"alone", "mean"}); !alone.is_null())
    table.rows.push_back(score_row("object.ply, rendered alone", alone));
  std::string html = table.html();
  Table checks{.caption = "Requested checks", .head = {"score", "at least", "found", "result"}};
  for (const Json& check : list_at(run.metrics, {"checks"}))
    checks.rows.push_back({score_title(json_text(value_at(check, {"score"}))),
                           decimal(number_at(check, {"at_least"}), 4), decimal(number_at(check, {"found"}), 4),
                           value_at(check, {"passed"}) == Json(true) ? "passed" : "<b>failed</b>"});
  if (!checks.rows.empty()) html += checks.html();
  return section("accuracy", "Accuracy", html);
}

std::string views_section(RunFolder& run, Pictures& pictures) {
  if (run.views.empty()) return {};
  const auto any = [&](std::string ShownView::*path) {
    return std::any_of(run.views.begin(), run.views.end(),
                       [&](const ShownView& view) { return !(view.*path).empty(); });
  };
  const bool scored = !run.views.front().scores.is_null();
  const std::string crops = pictures.crops(run), sheet = pictures.sheet(run);
  const bool input_as_truth = run.has_input_as_truth();
  const char* truth = !any(&ShownView::truth) ? "" : input_as_truth ? "input mask (no ground truth)" : "truth";
  std::string html = legend(truth, any(&ShownView::input) && !input_as_truth);
  if (!crops.empty()) html += "<h3>Where the worst views go wrong</h3><div class=\"sheet crops\">" + crops + "</div>";
  html += std::string("<h3>") + (scored ? "All views, worst boundary IoU first" : "All views") +
          "</h3><div class=sheet>" + sheet + "</div>";
  return "<div class=views>" + section("views", "Views", html) + "</div>";
}

std::string view_scores(const RunFolder& run) {
  Table table{.head = score_head("view")};
  for (const ShownView& view : run.views)
    if (!view.scores.is_null())
      table.rows.push_back(score_row(escaped(view.view + (view.object.empty() ? "" : " " + view.object)), view.scores));
  return table.rows.empty() ? std::string() : section("view-scores", "Scores of every view", table.html());
}

std::string objects_section(const RunFolder& run) {
  const Json& objects = list_at(run.metrics, {"objects"});
  if (objects.empty()) return {};
  Table scores{.caption = "Mean over the views of each object", .head = score_head("object")};
  Table errors{
      .caption = "Wrong pixels, summed over the views. Far: outside the 2 % band of the true contour.",
      .head = {"object", "pairs", "false positive", "far (leaks)", "false negative", "far (holes)", "true positive"}};
  for (const Json& object : objects) {
    const std::string name = json_text(value_at(object, {"object"}));
    scores.rows.push_back(score_row(name.empty() ? "object" : escaped(name), object));
    std::vector<std::string> row{name.empty() ? "object" : escaped(name), decimal(number_at(object, {"pairs"}), 0)};
    for (const char* key : {"fp", "far_fp", "fn", "far_fn", "tp"}) {
      const Json& count = value_at(object, {"counts", key});
      row.push_back(count.is_number_integer() ? with_separators(count.get<std::int64_t>()) : "–");
    }
    errors.rows.push_back(std::move(row));
  }
  return section("objects", "Objects", (objects.size() > 1 ? scores.html() : std::string()) + errors.html());
}

/// One row per decision, in three columns to fit a phone: reasons contain the measured value and its threshold.
std::string decisions_table(const Json& decisions) {
  Table table{.head = {"part", "state", "reason"}};
  for (const Json& decision : decisions) {
    const Json &mode = value_at(decision, {"mode"}), &saving = value_at(decision, {"saving"});
    std::string because = (mode == "auto" ? "" : json_text(mode) + ": ") + json_text(value_at(decision, {"reason"}));
    if (saving.is_string() && saving != "") because += "; saves " + json_text(saving);
    table.rows.push_back({escaped(json_text(value_at(decision, {"name"}))),
                          value_at(decision, {"on"}) == true ? "on" : "off", escaped(because)});
  }
  return table.html();
}

std::string decisions_section(const RunFolder& run) {
  const Json& decisions = value_at(run.report("ngs-joint"), {"result", "effects"});
  if (!decisions.is_structured() || decisions.empty()) return {};
  const bool is_list = decisions.is_array() && decisions[0].contains("on");
  return section("decisions", "Decisions",
                 "<p>Parts of the method, and whether they were on.</p>" +
                     (is_list ? decisions_table(decisions) : json_html(decisions)));
}

std::string times_section(const RunFolder& run) {
  double largest = 0;
  for (const ToolReport& tool : run.reports) largest = std::max(largest, seconds_of(value_at(tool.report, {"stages"})));
  if (!(largest > 0)) return {};
  std::string rows;
  for (const ToolReport& tool : run.reports) {
    const Json& stages = value_at(tool.report, {"stages"});
    if (stages.is_null()) continue;
    rows += bar_row("tool", tool.name, stages, largest);
    for (const Json& child : list_at(stages, {"children"}))
      if (seconds_of(child) >= 0.02 * largest)
        rows += bar_row("child", json_text(value_at(child, {"name"})), child, largest);
  }
  return section("times", "Stage times",
                 "<p class=note>Wall time of each tool and of its longer steps</p><div class=\"scroll "
                 "bars\"><table><thead><tr><th "
                 "scope=col>stage</th><th scope=col></th><th scope=col>time</th><th scope=col>work</th><th "
                 "scope=col>peak memory</th></tr></thead><tbody>" +
                     rows + "</tbody></table></div>");
}

std::string trace_section(const RunFolder& run) {
  const auto series = [&](const char* name, std::initializer_list<std::string_view> keys) {
    PlotSeries line{.name = name, .line = true};
    for (const Json& step : run.trace) line.points.push_back({number_at(step, {"t"}), number_at(step, keys), {}});
    return line;
  };
  std::string html;
  html += plot_svg({.title = "Agreement of the training views with their masks",
                    .x_label = "time of the optimisation, s",
                    .y_label = "share",
                    .series = {series("boundary IoU", {"training_biou"}), series("IoU", {"training_iou"})}});
  html += plot_svg({.title = "Loss of each step",
                    .x_label = "time of the optimisation, s",
                    .y_label = "loss",
                    .series = {series("total", {"loss", "total"}), series("mask", {"loss", "mask"})}});
  html += plot_svg({.title = "Duality gap: upper bound on the distance of the loss from its optimum",
                    .x_label = "time of the optimisation, s",
                    .y_label = "gap",
                    .series = {series("gap", {"gap"})}});
  return html.empty() ? html : section("trace", "Optimisation", "<div class=charts>" + html + "</div>");
}

std::string given_section(RunFolder& run, Pictures& pictures) {
  const std::string sheet = pictures.given_masks(run);
  if (sheet.empty()) return {};
  return section("given", "Input masks",
                 "<p class=note>Photos are dark outside the masks and grey where the mask is unknown.</p>" + sheet);
}

std::string inputs_section(const RunFolder& run) {
  std::string html;
  if (run.scene) {
    const Scene& scene = *run.scene;
    Table table;
    table.rows.push_back({"views", with_separators(std::int64_t(scene.views.size()))});
    if (!scene.views.empty()) {
      const Camera& camera = scene.views.front().camera;
      table.rows.push_back({"working size of the first view",
                            std::to_string(camera.width_px) + " × " + std::to_string(camera.height_px) + " px"});
    }
    if (scene.renders)
      table.rows.push_back({"photos", "none: rendered from the splat; " + decimal(100 * scene.renders->coverage, 1) +
                                          " % of its surface is visible in at least three views"});
    table.rows.push_back({"image scale", decimal(scene.image_scale, 4)});
    std::string objects;
    for (const SceneObject& object : scene.objects) objects += (objects.empty() ? "" : ", ") + escaped(object.name);
    table.rows.push_back({"objects", objects});
    html += table.html();
  }
  const Json& checks = value_at(run.report("ngs-scene"), {"result"});
  if (!checks.is_null() && !checks.empty()) html += details("Checks of ngs-scene", json_html(checks));
  Table hashes{.head = {"tool", "input", "path", "bytes", "hash (XXH3-128)"}};
  for (const ToolReport& tool : run.reports)
    for (const Json& input : list_at(tool.report, {"inputs"}))
      hashes.rows.push_back({escaped(tool.name), escaped(json_text(value_at(input, {"name"}))),
                             escaped(json_text(value_at(input, {"path"}))),
                             escaped(json_text(value_at(input, {"bytes"}))),
                             "<code>" + escaped(json_text(value_at(input, {"xxh3"}))) + "</code>"});
  if (!hashes.rows.empty()) html += details("Input files with hashes", hashes.html());
  return html.empty() ? html : section("inputs", "Inputs", html);
}

std::string tools_section(const RunFolder& run) {
  std::string html;
  for (const ToolReport& tool : run.reports) {
    const Json& report = tool.report;
    std::string body = "<p>ngs " + escaped(json_text(value_at(report, {"version"}))) + ", device " +
                       escaped(json_text(value_at(report, {"device", "name"}))) + " (" +
                       escaped(json_text(value_at(report, {"device", "reason"}))) + "), threads " +
                       escaped(json_text(value_at(report, {"threads"}))) + ", seed " +
                       escaped(json_text(value_at(report, {"seed"}))) + "</p>";
    Table options{.caption = "Resolved options"};
    const Json& resolved = value_at(report, {"options"});
    if (resolved.is_object())
      for (const auto& [key, value] : resolved.items())
        options.rows.push_back({"<code>" + escaped(key) + "</code>", json_html(value)});
    body += options.html();
    // Other sections show the file lists of ngs-eval and the checks of ngs-scene.
    if (!tool.name.starts_with("ngs-eval") && tool.name != "ngs-scene") body += json_html(value_at(report, {"result"}));
    html += details(escaped(tool.name), body);
  }
  return html.empty() ? html : section("tools", "Tools and options", html);
}

}  // namespace ngs::cli
