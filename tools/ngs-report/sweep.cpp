#include "sweep.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <sstream>

#include "ngs/core/error.h"
#include "ngs/core/parse_number.h"
#include "shared/page/html.h"
#include "shared/text/text_file.h"

namespace ngs::cli {
namespace {

namespace fs = std::filesystem;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Json read_json(const fs::path& path) {
  if (!fs::is_regular_file(path)) return nullptr;
  return parse_json(read_text_file(path.generic_string(), ErrorCode::kBadInput), path.generic_string());
}

int read_exit_code(const fs::path& path) {
  const std::string text = read_text_file(path.generic_string(), ErrorCode::kBadInput);
  int code = -1;
  std::from_chars(text.data(), text.data() + text.size(), code);
  return code;
}

SweepRun read_run(const fs::path& folder) {
  SweepRun run;
  const std::string repeat = folder.filename().string();
  std::from_chars(repeat.data(), repeat.data() + repeat.size(), run.repeat);
  run.exit_code = read_exit_code(folder / "done");
  const Json report = read_json(folder / "joint.json");
  run.wall_s = number_at(report, {"stages", "wall_s"});
  run.cpu_s = number_at(report, {"stages", "cpu_s"});
  const Json metrics = read_json(folder / "metrics.json");
  if (run.exit_code == 0 || run.exit_code == 7) run.scores = value_at(metrics, {"mean"});
  if (!fs::is_regular_file(folder / "trace.jsonl")) return run;
  std::istringstream lines(read_text_file((folder / "trace.jsonl").generic_string(), ErrorCode::kBadInput));
  for (std::string line; std::getline(lines, line);)
    if (Json step = parse_json(line, "trace.jsonl"); step.is_object() && step.contains("training_biou"))
      run.trace.push_back(std::move(step));
  return run;
}

/// Order by knob, then by setting; settings that start with a number are ordered numerically.
bool before(const SweepPoint& a, const SweepPoint& b) {
  if (a.knob != b.knob) return a.knob < b.knob;
  const auto number = [](const std::string& text) {
    double value = std::numeric_limits<double>::infinity();
    scan_number(text.data(), text.data() + text.size(), value);
    return value;
  };
  const double x = number(a.setting), y = number(b.setting);
  return x != y ? x < y : a.setting < b.setting;
}

Json read_once(const fs::path& folder) {
  Json once = Json::object();
  if (!fs::is_directory(folder)) return once;
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".json" && entry.path().parent_path().filename() == "reports")
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files)
    once[file.parent_path().parent_path().filename().string()][file.stem().string()] =
        number_at(read_json(file), {"stages", "cpu_s"});
  return once;
}

}  // namespace

Spread spread_of(std::vector<double> values) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  if (values.empty()) return {kNone, kNone, kNone};
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return {values.front(), (values[(n - 1) / 2] + values[n / 2]) / 2, values.back()};
}

bool SweepPoint::failed() const {
  return std::all_of(runs.begin(), runs.end(), [](const SweepRun& run) { return !run.scores.is_object(); });
}

Spread SweepPoint::time(bool cpu) const {
  std::vector<double> values;
  for (const SweepRun& run : runs) values.push_back(cpu ? run.cpu_s : run.wall_s);
  return spread_of(values);
}

Spread SweepPoint::score(const std::string& score_name) const {
  std::vector<double> values;
  for (const SweepRun& run : runs) values.push_back(number_at(run.scores, {score_name}));
  return spread_of(values);
}

Sweep read_sweep(const std::string& folder) {
  Sweep sweep;
  const fs::path points = fs::path(folder) / "points";
  if (fs::is_directory(points))
    for (const fs::directory_entry& entry : fs::directory_iterator(points)) {
      const std::string name = entry.path().filename().string();
      const std::size_t at = name.find('@');
      if (at == name.npos || !entry.is_directory()) continue;
      SweepPoint point{.knob = name.substr(0, at), .setting = name.substr(at + 1)};
      for (const fs::directory_entry& run : fs::directory_iterator(entry.path()))
        if (fs::is_regular_file(run.path() / "done")) point.runs.push_back(read_run(run.path()));
      std::sort(point.runs.begin(), point.runs.end(),
                [](const SweepRun& a, const SweepRun& b) { return a.repeat < b.repeat; });
      if (!point.runs.empty()) sweep.points.push_back(std::move(point));
    }
  if (sweep.points.empty())
    throw Error(ErrorCode::kBadInput, folder + ": no finished points, expected points/KNOB@SETTING/REPEAT/done",
                "make -f pipelines/work-precision.mk SCENE=... OUT=" + folder);
  std::sort(sweep.points.begin(), sweep.points.end(), before);
  sweep.once = read_once(fs::path(folder) / "once");
  sweep.numerical = read_json(fs::path(folder) / "numerical.json");
  return sweep;
}

void mark_frontier(Sweep& sweep, const std::string& score, bool cpu) {
  std::vector<SweepPoint*> order;
  for (SweepPoint& point : sweep.points)
    if (std::isfinite(point.score(score).median) && std::isfinite(point.time(cpu).median)) order.push_back(&point);
  std::stable_sort(order.begin(), order.end(), [&](const SweepPoint* a, const SweepPoint* b) {
    const double x = a->time(cpu).median, y = b->time(cpu).median;
    return x != y ? x < y : a->score(score).median > b->score(score).median;
  });
  double best = -std::numeric_limits<double>::infinity();
  for (SweepPoint* point : order)
    if (point->score(score).median > best) {
      best = point->score(score).median;
      point->frontier = true;
    }
}

std::array<double, 3> times_to_shares(const std::vector<Json>& trace) {
  std::array<double, 3> times{kNone, kNone, kNone};
  if (trace.size() < 2) return times;
  const auto value = [](const Json& line) { return number_at(line, {"training_biou"}); };
  const double first = value(trace.front()), last = value(trace.back()), begin = number_at(trace.front(), {"t"});
  if (!(last > first)) return times;
  constexpr std::array kShares = {0.5, 0.9, 0.99};
  for (std::size_t i = 0; i < kShares.size(); ++i)
    for (const Json& line : trace)
      if (value(line) >= first + kShares[i] * (last - first)) {
        times[i] = number_at(line, {"t"}) - begin;
        break;
      }
  return times;
}

}  // namespace ngs::cli
