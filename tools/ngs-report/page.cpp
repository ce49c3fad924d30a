#include "page.h"

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "charts.h"
#include "ngs/ops/image/metrics.h"
#include "sections.h"
#include "shared/page/html.h"
#include "shared/page/mask_sheet.h"

namespace ngs::cli {
namespace {

std::string comparison(const std::vector<RunFolder>& runs) {
  Table table{.caption = "Mean scores of each run", .head = {"run", "method", "time"}};
  for (std::string_view name : kScoreNames) table.head.emplace_back(score_title(name));
  PlotSeries dots{.line = false};
  for (const RunFolder& run : runs) {
    std::vector<std::string> row{escaped(run.title), escaped(method_title(run)), duration(run_seconds(run))};
    for (std::string_view name : kScoreNames) row.push_back(decimal(number_at(run.metrics, {"mean", name}), 4));
    table.rows.push_back(std::move(row));
    dots.points.push_back({run_seconds(run), number_at(run.metrics, {"mean", "biou"}), run.title});
  }
  std::vector<std::string> mean{"mean over runs", "", ""};
  for (std::string_view name : kScoreNames) mean.push_back(decimal(mean_over_runs(runs, name), 4));
  table.rows.push_back(std::move(mean));
  const std::string plot = plot_svg({.title = "Boundary IoU against time",
                                     .x_label = "time of the whole chain, s",
                                     .y_label = "boundary IoU",
                                     .series = {dots}});
  return section("comparison", "Comparison", table.html() + plot);
}

std::string run_html(const Exec& exec, RunFolder& run, Pictures& pictures, const PageOutputs& outputs) {
  const std::string views = views_section(run, pictures);  // first: may add problems
  const std::string errors = errors_section(exec, run, pictures, outputs.atlas);
  const std::string overview = overview_section(exec, run, pictures, outputs.viewer);
  const std::string marked = marked_section(run, pictures);
  const std::string boundary = boundary_section(run, pictures);
  const std::string given = given_section(run, pictures);  // last: uses the remaining picture budget
  const std::string made = accuracy_section(run) + view_scores(run) + errors + boundary + given + objects_section(run) +
                           decisions_section(run) + times_section(run) + trace_section(run) + inputs_section(run) +
                           repeat_section(run) + tools_section(run);
  return overview + tiles(run) + warnings_section(run) + marked + views +
         (made.empty() ? made
                       : "<details class=made><summary><b>How it was made</b></summary>" + made + "</details>\n");
}

/// "2 objects cut out of a 3D Gaussian splat by METHOD.": HTML.
std::string what_was_made(const RunFolder& run) {
  const std::size_t objects = run.scene ? run.scene->objects.size() : 1;
  const std::string method = method_title(run);
  return (objects > 1 ? with_separators(std::int64_t(objects)) + " objects" : std::string("Object")) +
         " cut out of a 3D Gaussian splat" + (method == "–" ? "" : " by " + escaped(method)) + ".";
}

/// Section ids must be unique on a page of several runs.
std::string with_prefix(std::string html, const std::string& prefix) {
  const std::string mark = "<section id=\"";
  for (std::size_t at = html.find(mark); at != html.npos; at = html.find(mark, at + mark.size() + prefix.size()))
    html.insert(at + mark.size(), prefix);
  return html;
}

}  // namespace

std::string address_from(const std::string& page, const std::string& to) {
  namespace fs = std::filesystem;
  const std::string path = fs::absolute(to).lexically_relative(fs::absolute(page).parent_path()).generic_string();
  std::string address = "./";  // so that no name is parsed as a URL scheme
  for (const char c : path) {
    char code[8];
    std::snprintf(code, sizeof code, "%%%02X", unsigned(static_cast<unsigned char>(c)));
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       std::string_view("/._~-").find(c) != std::string_view::npos;
    address += plain ? std::string(1, c) : std::string(code);
  }
  return address;
}

std::string means_table(const std::vector<RunFolder>& runs) {
  char line[160];
  const auto row = [&](const std::string& name, const auto& score) {
    std::snprintf(line, sizeof line, "%-28.28s  %9s  %9s  %9s  %9s\n", name.c_str(), decimal(score("iou"), 4).c_str(),
                  decimal(score("accuracy"), 4).c_str(), decimal(score("biou"), 4).c_str(),
                  decimal(score("contour_f"), 4).c_str());
    return std::string(line);
  };
  std::snprintf(line, sizeof line, "%-28s  %9s  %9s  %9s  %9s\n", "run", "iou", "accuracy", "biou", "contour_f");
  std::string table = line;
  for (const RunFolder& run : runs)
    table += row(run.title, [&](const char* score) { return number_at(run.metrics, {"mean", score}); });
  if (runs.size() > 1) table += row("mean over runs", [&](const char* score) { return mean_over_runs(runs, score); });
  return table;
}

Json means_json(const std::vector<RunFolder>& runs) {
  Json means = Json::object();
  for (std::string_view score : kScoreNames) {
    const double mean = mean_over_runs(runs, score);
    means[std::string(score)] = std::isfinite(mean) ? Json(mean) : Json();
  }
  return means;
}

std::string report_page(const Exec& exec, std::vector<RunFolder>& runs, const PictureOptions& options,
                        const PageOutputs& outputs) {
  Pictures pictures(options);
  std::string title = runs.size() == 1 ? runs[0].title : std::to_string(runs.size()) + " runs";
  std::string body;
  if (runs.size() > 1) body += comparison(runs);
  if (runs.size() == 1) body += run_html(exec, runs[0], pictures, outputs);
  for (std::size_t i = 0; runs.size() > 1 && i < runs.size(); ++i)
    body += "<details class=run><summary><b>" + escaped(runs[i].title) + "</b></summary>" +
            with_prefix(run_html(exec, runs[i], pictures, {}), "run" + std::to_string(i + 1) + "-") + "</details>\n";
  const std::string scene = runs.size() == 1 && runs[0].scene ? scene_title(*runs[0].scene) : "";
  const bool named = !scene.empty() && scene != title;
  const std::string note =
      runs.size() > 1 ? "Objects cut out of 3D Gaussian splats."
                      : (named ? "Run <b>" + escaped(title) + "</b>. " : std::string()) + what_was_made(runs[0]);
  return page_start(title + (named ? " – " + scene : "") + " – ngs report", named ? scene : title, note) + body +
         page_end();
}

}  // namespace ngs::cli
