#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "charts.h"
#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/ops/image/metrics.h"
#include "ngs/options/near_matches.h"
#include "shared/page/html.h"
#include "shared/tool.h"
#include "sweep.h"

namespace ngs::cli {
namespace {

constexpr int kDigits = 4;

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json spread_json(const Spread& s) {
  return {{"min", number_or_null(s.min)}, {"median", number_or_null(s.median)}, {"max", number_or_null(s.max)}};
}

std::string spread_cell(const Spread& s, int digits) {
  if (!std::isfinite(s.median)) return "–";
  std::string cell = decimal(s.median, digits);
  if (s.min != s.max) cell += " <small>" + decimal(s.min, digits) + " to " + decimal(s.max, digits) + "</small>";
  return cell;
}

std::string unit_of(const SweepView& view) {
  return view.cpu ? "CPU seconds of ngs-joint" : "wall seconds of ngs-joint";
}

PlotPoint dot_of(const SweepPoint& point, const SweepView& view, const std::string& label) {
  const Spread time = point.time(view.cpu), score = point.score(view.score);
  return {time.median, score.median, label, time.min, time.max, score.min, score.max};
}

std::vector<const SweepPoint*> frontier_of(const Sweep& sweep, const SweepView& view) {
  std::vector<const SweepPoint*> frontier;
  for (const SweepPoint& point : sweep.points)
    if (point.frontier) frontier.push_back(&point);
  std::sort(frontier.begin(), frontier.end(), [&](const SweepPoint* a, const SweepPoint* b) {
    return a->time(view.cpu).median < b->time(view.cpu).median;
  });
  return frontier;
}

std::string frontier_section(const Sweep& sweep, const SweepView& view) {
  PlotSeries beaten{.line = false}, best = beaten, line{.points = {}};
  for (const SweepPoint& point : sweep.points)
    if (!point.frontier) beaten.points.push_back(dot_of(point, view, {}));
  Table table{.caption = "Pareto frontier: no other point is both faster and better",
              .head = {"point", unit_of(view), view.score}};
  for (const SweepPoint* point : frontier_of(sweep, view)) {
    best.points.push_back(dot_of(*point, view, point->name()));
    line.points.push_back({point->time(view.cpu).median, point->score(view.score).median, {}});
    table.rows.push_back({escaped(point->name()), spread_cell(point->time(view.cpu), 2),
                          spread_cell(point->score(view.score), kDigits)});
  }
  const std::string plot = plot_svg({.title = "Task accuracy against time: all points and the frontier",
                                     .x_label = unit_of(view) + " (logarithmic)",
                                     .y_label = view.score,
                                     .series = {line, best, beaten},
                                     .log_x = true});
  return section("frontier", "Frontier", plot + table.html());
}

std::string knobs_section(const Sweep& sweep, const SweepView& view) {
  std::map<std::string, PlotSeries> knobs;
  std::vector<double> scores;  // all plots share the score range, so that a knob without effect looks flat
  for (const SweepPoint& point : sweep.points) {
    scores.push_back(point.score(view.score).median);
    PlotSeries& series = knobs.try_emplace(point.knob, PlotSeries{.line = false}).first->second;
    if (!point.failed()) series.points.push_back(dot_of(point, view, point.setting));
  }
  std::string plots;
  for (const auto& [knob, series] : knobs) {
    std::vector<PlotPoint> extent;
    for (const double score : scores)
      if (!series.points.empty()) extent.push_back({series.points.front().x, score, {}});
    plots += plot_svg({.title = knob,
                       .x_label = unit_of(view) + " (logarithmic)",
                       .y_label = view.score,
                       .series = {series},
                       .log_x = true,
                       .extent = extent});
  }
  return section("knobs", "Knob by knob", "<div class=charts>" + plots + "</div>");
}

std::string points_section(const Sweep& sweep) {
  Table table{.caption = "All points; median, and min to max of repeated runs. Includes failures.",
              .head = {"point", "runs", "exit codes", "wall s", "CPU s", "IoU", "B-IoU 0.02", "B-IoU 0.005", "frontier",
                       "50 % s", "90 % s", "99 % s"}};
  for (const SweepPoint& point : sweep.points) {
    std::string codes;
    for (const SweepRun& run : point.runs) codes += (codes.empty() ? "" : " ") + std::to_string(run.exit_code);
    std::vector<std::string> row{escaped(point.name()),
                                 std::to_string(point.runs.size()),
                                 codes,
                                 spread_cell(point.time(false), 2),
                                 spread_cell(point.time(true), 2),
                                 spread_cell(point.score("iou"), kDigits),
                                 spread_cell(point.score("biou"), kDigits),
                                 spread_cell(point.score("biou_005"), kDigits),
                                 point.frontier ? "yes" : ""};
    for (const double t : times_to_shares(point.runs.front().trace)) row.push_back(decimal(t, 2));
    table.rows.push_back(std::move(row));
  }
  return section(
      "points", "Points",
      "<div class=scroll>" + table.html() +
          "</div><p class=note>50, 90, 99 %: wall time until this share of the total gain in agreement with the "
          "training masks was reached, without scoring.</p>");
}

/// Agreement with the training masks over time, for the four runs with the most evaluations.
std::string anytime_section(const Sweep& sweep) {
  std::vector<const SweepPoint*> longest;
  for (const SweepPoint& point : sweep.points)
    if (point.runs.front().trace.size() > 2) longest.push_back(&point);
  std::stable_sort(longest.begin(), longest.end(), [](const SweepPoint* a, const SweepPoint* b) {
    return a->runs.front().trace.size() > b->runs.front().trace.size();
  });
  std::string plots;
  for (std::size_t i = 0; i < std::min<std::size_t>(longest.size(), 4); ++i) {
    PlotSeries line{.points = {}};
    const std::vector<Json>& trace = longest[i]->runs.front().trace;
    for (const Json& step : trace)
      line.points.push_back(
          {number_at(step, {"t"}) - number_at(trace.front(), {"t"}), number_at(step, {"training_biou"}), {}});
    plots += plot_svg({.title = longest[i]->name(),
                       .x_label = "wall seconds since the first evaluation, without evaluations",
                       .y_label = "B-IoU, training masks",
                       .series = {line}});
  }
  return plots.empty() ? plots
                       : section("anytime", "Accuracy over time within a run", "<div class=charts>" + plots + "</div>");
}

/// Best score at equal time, and least time at equal score.
std::string equal_section(const Sweep& sweep, const SweepView& view) {
  const auto frontier = frontier_of(sweep, view);
  if (frontier.empty()) return {};
  Table in_time{.caption = "At equal time", .head = {"within", "best point", view.score}};
  const double least = frontier.front()->time(view.cpu).median, most = frontier.back()->time(view.cpu).median;
  for (double t = least; t < 2 * most; t *= 2) {
    const SweepPoint* best = nullptr;
    for (const SweepPoint* point : frontier)
      if (point->time(view.cpu).median <= t) best = point;
    if (best != nullptr)
      in_time.rows.push_back({duration(t), escaped(best->name()), decimal(best->score(view.score).median, kDigits)});
  }
  Table at_quality{.caption = "At equal quality", .head = {"loss against the best", "least time", "point"}};
  const double top = frontier.back()->score(view.score).median;
  for (const double loss : {0.0, 0.001, 0.005, 0.01, 0.02, 0.05}) {
    const auto* found = *std::find_if(frontier.begin(), frontier.end(), [&](const SweepPoint* point) {
      return point->score(view.score).median >= top - loss;
    });
    at_quality.rows.push_back({decimal(loss, 3), duration(found->time(view.cpu).median), escaped(found->name())});
  }
  return section("equal", "Equal time, equal quality", in_time.html() + at_quality.html());
}

std::string once_section(const Sweep& sweep) {
  Table table{.caption = "One-off cost per scene, for any number of objects", .head = {"scene", "tool", "CPU s"}};
  for (const auto& [name, tools] : sweep.once.items())
    for (const auto& [tool, seconds] : tools.items())
      table.rows.push_back(
          {escaped(name), escaped(tool), decimal(seconds.is_number() ? seconds.get<double>() : NAN, 2)});
  return table.rows.empty() ? std::string() : section("once", "One-off cost", table.html());
}

std::string numerical_section(const Sweep& sweep) {
  const Json& points = value_at(sweep.numerical, {"points"});
  if (!points.is_array() || points.empty()) return {};
  std::map<std::string, PlotSeries> knobs;
  Table table{.caption = "Error against the reference", .head = {"knob", "setting", "CPU s", "largest error"}};
  for (const Json& point : points) {
    const std::string knob = json_text(value_at(point, {"knob"})), setting = json_text(value_at(point, {"setting"}));
    const double seconds = number_at(point, {"cpu_s"}), error = number_at(point, {"error"});
    PlotSeries& series = knobs.try_emplace(knob, PlotSeries{.line = false}).first->second;
    char text[32] = "the reference";
    if (error > 0) {
      series.points.push_back({seconds, std::log10(error), knob + " " + setting});
      std::snprintf(text, sizeof text, "%.2e", error);
    }
    table.rows.push_back({escaped(knob), escaped(setting), decimal(seconds, 4), text});
  }
  std::vector<PlotSeries> series;
  for (auto& [knob, s] : knobs) series.push_back(std::move(s));
  return section("numerical", "Numerical error",
                 "<p>" + escaped(json_text(value_at(sweep.numerical, {"reference"}))) + "</p>" +
                     plot_svg({.title = "Numerical error against time; independent of task accuracy",
                               .x_label = "CPU seconds (logarithmic)",
                               .y_label = "log10 of the largest error",
                               .series = series,
                               .log_x = true}) +
                     table.html());
}

struct WorkPrecisionOptions {
  std::string score = "biou", time = "wall";

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.score, Text{"score", "iou|biou|biou_005|...", "Accuracy score: a mean in metrics.json"});
    visit(self.time, Text{"time", "wall|cpu", "Time to plot; use cpu on a shared machine"});
  }
};

}  // namespace

std::string sweep_page(const Sweep& sweep, const SweepView& view) {
  return page_start("Work and precision – ngs report", "Work and precision",
                    "Accuracy is measured on test views that were kept back.") +
         frontier_section(sweep, view) + knobs_section(sweep, view) + equal_section(sweep, view) +
         anytime_section(sweep) + numerical_section(sweep) + once_section(sweep) + points_section(sweep) + page_end();
}

Json sweep_json(const Sweep& sweep, const SweepView& view) {
  Json points = Json::array();
  for (const SweepPoint& point : sweep.points) {
    Json runs = Json::array();
    for (const SweepRun& run : point.runs) {
      const auto times = times_to_shares(run.trace);
      runs.push_back({{"repeat", run.repeat},
                      {"exit_code", run.exit_code},
                      {"wall_s", number_or_null(run.wall_s)},
                      {"cpu_s", number_or_null(run.cpu_s)},
                      {"scores", run.scores},
                      {"gain_s", {number_or_null(times[0]), number_or_null(times[1]), number_or_null(times[2])}}});
    }
    points.push_back({{"knob", point.knob},
                      {"setting", point.setting},
                      {"failed", point.failed()},
                      {"frontier", point.frontier},
                      {"wall_s", spread_json(point.time(false))},
                      {"cpu_s", spread_json(point.time(true))},
                      {"score", spread_json(point.score(view.score))},
                      {"runs", std::move(runs)}});
  }
  return {{"ngs_work_precision", 1},  {"score", view.score},         {"time", view.cpu ? "cpu" : "wall"},
          {"once_cpu_s", sweep.once}, {"points", std::move(points)}, {"numerical", sweep.numerical}};
}

/// A cell of a CSV file (RFC 4180).
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == text.npos) return text;
  std::string cell = "\"";
  for (const char c : text) cell += c == '"' ? "\"\"" : std::string(1, c);
  return cell + "\"";
}

std::string sweep_csv(const Sweep& sweep) {
  std::string csv = "knob,setting,repeat,exit_code,wall_s,cpu_s,iou,biou,biou_005,frontier\n";
  // Enough digits to avoid double rounding.
  const auto cell = [](double value) { return std::isfinite(value) ? decimal(value, 9) : std::string(); };
  for (const SweepPoint& point : sweep.points)
    for (const SweepRun& run : point.runs)
      csv += quoted(point.knob) + "," + quoted(point.setting) + "," + std::to_string(run.repeat) + "," +
             std::to_string(run.exit_code) + "," + cell(run.wall_s) + "," + cell(run.cpu_s) + "," +
             cell(number_at(run.scores, {"iou"})) + "," + cell(number_at(run.scores, {"biou"})) + "," +
             cell(number_at(run.scores, {"biou_005"})) + "," + (point.frontier ? "1" : "0") + "\n";
  return csv;
}

int work_precision_command(int argc, char** argv) {
  Tool tool("ngs-report work-precision", "Show a sweep: accuracy against time, knob by knob, with its frontier.",
            {"ngs-report work-precision out/work-precision -o page.html --points-json points.json"});
  WorkPrecisionOptions options;
  tool.options(options);
  const Input& folder = tool.input("sweep", "OUT of pipelines/work-precision.mk");
  const Output& out = tool.output("-o,--output", "HTML page");
  const Output& json = tool.optional_output("--points-json", "all points with derived values");
  const Output& csv = tool.optional_output("--points-csv", "one line per run");
  return tool.run(argc, argv, [&](Run& run) {
    if (options.time != "wall" && options.time != "cpu")
      throw Error(ErrorCode::kUsage, "--time: '" + options.time + "', expected wall or cpu");
    if (std::find(kScoreNames.begin(), kScoreNames.end(), options.score) == kScoreNames.end())
      throw Error(ErrorCode::kUsage, "--score: '" + options.score + "' is not a mask score",
                  suggestion(options.score, {kScoreNames.begin(), kScoreNames.end()}));
    const SweepView view{options.score, options.time == "cpu"};
    Sweep sweep = read_sweep(folder.path);
    mark_frontier(sweep, view.score, view.cpu);
    run.result()["points"] = sweep.points.size();
    if (run.dry_run()) return 0;
    io::write_file(out.path, sweep_page(sweep, view));
    if (json) io::write_file(json.path, sweep_json(sweep, view).dump(1) + "\n");
    if (csv) io::write_file(csv.path, sweep_csv(sweep));
    for (const SweepPoint* point : frontier_of(sweep, view)) run.result()["frontier"].push_back(point->name());
    return 0;
  });
}

}  // namespace ngs::cli
