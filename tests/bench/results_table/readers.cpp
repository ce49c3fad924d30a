#include "readers.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "ngs/core/error.h"

namespace ngs::results {
namespace {

template <class Read>
auto read_json(const std::string& path, const std::string& expected, Read&& read) {
  try {
    return read(Json::parse(read_text(path)));
  } catch (const Json::exception& e) {
    throw Error(ErrorCode::kBadInput, path + ": " + e.what() + ", expected " + expected);
  }
}

std::vector<Json> benchmark_rows(const Json& file) {
  std::vector<Json> rows;
  for (const Json& entry : file.at("benchmarks")) {
    if (entry.value("aggregate_name", "") != "median") continue;
    const std::string name = entry.at("run_name");
    const std::size_t slash = std::min(name.find('/'), name.size());
    std::string kernel = name.substr(0, slash);
    std::replace(kernel.begin(), kernel.end(), '_', ' ');
    Json row{{"kernel", kernel}, {"isa", slash < name.size() ? name.substr(slash + 1) : "-"}};
    row["cpu_ms"] = rounded(entry.at("cpu_time"));
    if (entry.contains("pairs/s")) row["mega_pairs_s"] = rounded(1e-6 * entry["pairs/s"].get<double>());
    rows.push_back(std::move(row));
  }
  // the file has completion order
  std::stable_sort(rows.begin(), rows.end(), [](const Json& a, const Json& b) { return a["kernel"] < b["kernel"]; });
  return rows;
}

/// Infinity if not a number, which means a wrong result.
double ratio_of(const Json& ratio) { return ratio.is_number() ? ratio.get<double>() : INFINITY; }

double worst_of(const Json& stability_case, const char* key) {
  double worst = 0;
  for (const Json& at : stability_case.at("sweep"))
    if (!at.at(key).is_null()) worst = std::max(worst, ratio_of(at.at(key)));
  return worst;
}

/// Small suites share a table row.
std::string group_of(const std::string& kernel) {
  static const std::map<std::string, std::string> groups{
      {"align", "losses"},      {"continuity", "losses"},     {"mask loss", "losses"}, {"photometric", "losses"},
      {"smoothness", "losses"}, {"adam", "solvers"},          {"anderson", "solvers"}, {"label solve", "solvers"},
      {"pose step", "solvers"}, {"invariance", "end to end"}, {"joint", "end to end"}, {"masks", "end to end"}};
  const auto at = groups.find(kernel);
  return at == groups.end() ? kernel : at->second;
}

void count(Json& row, const char* key) { row[key] = row[key].get<int>() + 1; }
void raise(Json& row, const char* key, double value) { row[key] = std::max(row.value(key, 0.0), rounded(value)); }

void add_case(Json& row, const Json& stability_case) {
  count(row, "cases");
  if (!stability_case.at("passed").get<bool>()) count(row, "failed");
  if (stability_case.at("budget").get<double>() > 0)
    raise(row, "worst_ratio", worst_of(stability_case, "ratio"));
  else
    count(row, "exact");
  if (stability_case.at("textbook").get<std::string>().rfind("not applicable", 0) == 0) return;
  count(row, "textbook");
  const double textbook = worst_of(stability_case, "textbook_ratio");
  if (std::isfinite(textbook))
    raise(row, "textbook_ratio", textbook);
  else
    count(row, "textbook_wrong");
}

std::vector<Json> stability_rows(const Json& file) {
  std::vector<Json> rows;
  for (const Json& stability_case : file.at("cases")) {
    const std::string kernel = group_of(stability_case.at("kernel"));
    auto row = std::find_if(rows.begin(), rows.end(), [&](const Json& r) { return r["kernel"] == kernel; });
    if (row == rows.end())
      row = rows.insert(
          row,
          Json{{"kernel", kernel}, {"cases", 0}, {"exact", 0}, {"failed", 0}, {"textbook", 0}, {"textbook_wrong", 0}});
    add_case(*row, stability_case);
  }
  return rows;
}

}  // namespace

double rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.7g", value);
  return std::strtod(text, nullptr);
}

Json read_scores(const std::string& path) {
  return read_json(path, "metrics.json of ngs-eval", [](const Json& file) {
    Json scores = Json::object();
    for (const char* key : {"iou", "biou", "biou_005"}) scores[key] = rounded(file.at("mean").at(key));
    return scores;
  });
}

Json read_times(const std::string& path) {
  return read_json(path, "a tool's report", [](const Json& file) {
    const Json& stages = file.at("stages");
    return Json{{"wall_s", rounded(stages.at("wall_s"))},
                {"cpu_s", rounded(stages.at("cpu_s"))},
                {"peak_mib", rounded(stages.at("max_rss_mib"))}};
  });
}

Json read_halves(const std::string& path) {
  return read_json(path, "metrics.json of ngs-eval --halves", [](const Json& file) {
    Json scores = Json::object();
    const auto add = [&](const std::string& prefix, const Json& values) {
      for (const auto& [key, value] : values.items())
        if (value.is_number()) scores[prefix + key] = rounded(value);
    };
    for (const char* group : {"seen", "unseen"}) add(std::string(group) + "_", file.at("object").at(group));
    const Json& background = file.at("background");
    for (const char* group : {"photos", "new"}) add(std::string(group) + "_", background.at(group));
    add("", background);
    add("outside_", background.at("outside_change"));
    return scores;
  });
}

std::vector<Json> read_rows(const std::string& kind, const std::string& path) {
  if (kind == "benchmark") return read_json(path, "JSON of google-benchmark", benchmark_rows);
  if (kind == "stability") return read_json(path, "stability.json", stability_rows);
  throw Error(ErrorCode::kBadInput, "rows of '" + kind + "', expected benchmark or stability");
}

}  // namespace ngs::results
