#include "shared/run/report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <utility>

#include "ngs/core/formatted.h"
#include "ngs/io/files/shell_word.h"
#include "shared/cli/exit_code.h"
#include "shared/cli/version.h"
#include "shared/os/machine.h"
#include "shared/text/layout.h"

namespace ngs::cli {
namespace {

Json stage_json(const StageNode& node) {
  Json stage = {{"name", node.name},
                {"wall_s", node.wall_s},
                {"cpu_s", node.cpu_s},
                {"items", node.items},
                {"items_per_s", node.wall_s > 0 ? double(node.items) / node.wall_s : 0.0},
                {"max_rss_mib", node.max_rss_mib},
                {"children", Json::array()}};
  for (const StageNode& child : node.children) stage["children"].push_back(stage_json(child));
  return stage;
}

/// "output" of "-o,--output".
std::string long_name(const std::string& flags) { return flags.substr(flags.rfind("--") + 2); }

Json whole_numbers(const Json& result) {
  Json counts = Json::object();
  for (const auto& [name, value] : result.items())
    if (value.is_number_integer()) counts[name] = value;
  return counts;
}

Json object_schema(Json properties, const std::vector<std::string>& optional = {}) {
  Json required = Json::array();
  for (const auto& [name, unused] : properties.items())
    if (std::find(optional.begin(), optional.end(), name) == optional.end()) required.push_back(name);
  return {{"type", "object"},
          {"additionalProperties", false},
          {"required", required},
          {"properties", std::move(properties)}};
}

/// The values that a common flag accepts. The default is left out: for some flags it means that the tool chooses.
Json common_flag_schema(const char* name) {
  CommonFlags flags;
  OptionSet set;
  set.add(flags);
  Json schema = set.property_schema(name);
  schema.erase("default");
  schema.erase("maximum");  // readers of JSON differ beyond 2^53
  return schema;
}

namespace fs = std::filesystem;
constexpr std::size_t kMaxOutputs = 4, kMaxFigures = 5;

/// The usual next command. {-o} is the output of that flag, {scene} the input of that name.
const std::map<std::string, std::string>& next_commands() {
  static const std::map<std::string, std::string> next = {
      {"ngs-synth", "ngs-scene import {-o} -o scene.json"},
      {"ngs-scene import", "ngs-variance {-o} -o boundary.ply"},
      {"ngs-variance", "ngs-joint {scene} {-o} -o labelled.ply"},
      {"ngs-sample", "ngs-rbf {boundary} {-o} -o field.ply"},
      {"ngs-joint", "ngs-extract {-o} --object-ply object.ply --background-ply background.ply"},
      {"ngs-extract", "open {--object-ply} in a splat viewer"},
      {"ngs-report", "open {-o} in a browser"}};
  return next;
}

/// Empty if it was not given.
std::string path_of(const Spec& spec, const std::string& name) {
  for (const Input& input : spec.inputs)
    if (input.name == name) return input.path;
  for (const Output& output : spec.outputs)
    if (output.flags == name || output.flags.starts_with(name + ",")) return output.path;
  return {};
}

/// Empty if the tool has no usual next command, or if a path in it was not given.
std::string next_command(const Spec& spec) {
  const auto found = next_commands().find(spec.name);
  if (found == next_commands().end()) return {};
  std::string command = found->second;
  for (std::size_t open = 0; (open = command.find('{', open)) != command.npos;) {
    const std::size_t close = command.find('}', open);
    const std::string path = path_of(spec, command.substr(open + 1, close - open - 1));
    if (path.empty()) return {};
    command.replace(open, close - open + 1, io::shell_word(path));
  }
  return command;
}

std::string size_text(double bytes) {
  const double mib = bytes / (1 << 20);
  if (mib >= 1024) return formatted("%.1f GiB", mib / 1024);
  return mib >= 1 ? formatted("%.0f MiB", mib) : formatted("%.0f KiB", std::max(1.0, bytes / 1024));
}

/// "a.ply, 149 MiB" or "masks, 34 files".
std::string output_text(const std::string& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) {
    const auto files = std::count_if(fs::recursive_directory_iterator(path, error), fs::recursive_directory_iterator(),
                                     [&](const fs::directory_entry& entry) { return entry.is_regular_file(error); });
    return path + ", " + std::to_string(files) + " files";
  }
  const auto bytes = fs::file_size(path, error);
  return error ? path : path + ", " + size_text(double(bytes));
}

std::string number_text(const Json& value) {
  if (value.is_number_integer()) return value.dump();
  return formatted("%.4g", value.get<double>());
}

/// "views 30, gaussians 12000": the first numbers of an object.
std::string figures(const Json& object) {
  std::string text;
  std::size_t count = 0;
  for (const auto& [name, value] : object.items())
    if (value.is_number() && count < kMaxFigures) {
      std::string words = name;
      std::ranges::replace(words, '_', ' ');
      text += (count++ > 0 ? ", " : "") + words + " " + number_text(value);
    }
  return text;
}

/// For some tools: the most useful figures, under readable names.
Json key_figures(const std::string& tool, const Json& result) {
  static const std::map<std::string, std::vector<std::pair<std::string, std::string>>> key_names = {
      {"ngs-joint", {{"boundary", "boundary Gaussians"}, {"rows_changed", "changed Gaussians"}, {"steps", "steps"}}}};
  const auto found = key_names.find(tool);
  if (found == key_names.end()) return result;
  Json named = Json::object();
  for (const auto& [key, name] : found->second)
    if (result.contains(key)) named[name] = result[key];
  return named;
}

/// The estimates of a dry run, else the scores if the run has any, else its other figures.
std::string outcome_text(const std::string& tool, const Json& report) {
  if (report["dry_run"] == true && report.contains("plan")) return figures(report["plan"]);
  if (const Json& result = report["result"]; result.contains("mean") && result["mean"].is_object()) {
    Json scores = Json::object();
    for (const char* name : {"iou", "biou", "accuracy", "psnr_db", "ssim"})
      if (result["mean"].contains(name)) scores[name] = result["mean"][name];
    return figures(scores);
  }
  return figures(key_figures(tool, report["result"]));
}

std::string outcome_line(const Json& report) {
  const std::string duration = duration_text(report["stages"]["wall_s"].get<double>());
  if (report["dry_run"] == true) return "dry run, nothing was done";
  if (report["exit_code"] == kCheckFailed) return "done in " + duration + ", a requested check failed";
  if (report["exit_code"] == kBudgetHit) return "time budget used up after " + duration + "; the result is partial";
  return "done in " + duration;
}

std::string chain_line(const Spec& spec, const Json& report) {
  std::string line = "[" + stage_of_chain() + "] " + spec.name + ": " + outcome_line(report);
  for (const Json& output : report["outputs"]) {
    line += ", " + fs::path(output["path"].get<std::string>()).filename().string();
    if (report["outputs"].size() > 2) return line + " and others\n";
  }
  return line + "\n";
}

}  // namespace

Json make_report(const ReportData& data) {
  Json inputs = Json::array(), outputs = Json::array();
  for (const ReadInput& input : data.inputs) {
    Json record = {{"name", input.name}, {"path", input.path}, {"bytes", input.bytes}};
    if (!input.xxh3.empty()) record["xxh3"] = input.xxh3;
    inputs.push_back(std::move(record));
  }
  for (const Output& output : data.spec.outputs)
    if (output && !data.spec.writes_nothing())
      outputs.push_back({{"name", long_name(output.flags)}, {"path", data.streams.given(output.path)}});
  StageNode root = data.monitor.root();
  root.name = data.spec.name;
  root.wall_s = data.wall_s;
  root.cpu_s = data.cpu_s;
  for (const StageNode& child : root.children) root.max_rss_mib = std::max(root.max_rss_mib, child.max_rss_mib);

  Json report = {{"tool", data.spec.name},
                 {"version", version_with_commit()},
                 {"options", data.spec.options.to_json()},
                 {"seed", data.flags.seed},
                 {"inputs", std::move(inputs)},
                 {"outputs", std::move(outputs)},
                 {"device",
                  {{"kind", data.device.device == Device::kCuda ? "cuda" : "cpu"},
                   {"name", data.device.name},
                   {"reason", data.device.reason},
                   {"fast_atomics", data.device.sums == DeviceSums::kAtomic}}},
                 {"threads", data.threads},
                 {"isa", isa_name(data.isa)},
                 {"dry_run", data.flags.dry_run},
                 {"exit_code", data.exit_code},
                 {"stages", stage_json(root)},
                 {"counts", whole_numbers(data.result)},
                 {"result", data.result},
                 {"warnings", data.monitor.warnings()}};
  if (data.flags.dry_run || !data.plan.empty()) report["plan"] = data.plan;
  return report;
}

Json report_schema(const Spec& spec) {
  const Json text = {{"type", "string"}}, count = {{"type", "integer"}, {"minimum", 0}};
  const Json seconds = {{"type", "number"}, {"minimum", 0}}, free_object = {{"type", "object"}};
  const auto list_of = [](Json items) { return Json{{"type", "array"}, {"items", std::move(items)}}; };
  const Json hash = {{"type", "string"}, {"pattern", "^[0-9a-f]{32}$"}};
  const Json counts = {{"type", "object"}, {"additionalProperties", {{"type", "integer"}}}};
  std::string file = spec.name + ".schema.json";
  std::ranges::replace(file, ' ', '-');
  // The report has all options; the schema of an options file allows no others, but requires none.
  const Json options = {{"allOf", {{{"$ref", "../options/" + file}}}},
                        {"minProperties", spec.options.entries().size()}};
  const Json stage = object_schema({{"name", text},
                                    {"wall_s", seconds},
                                    {"cpu_s", seconds},
                                    {"items", count},
                                    {"items_per_s", seconds},
                                    {"max_rss_mib", seconds},
                                    {"children", list_of({{"$ref", "#/definitions/stage"}})}});
  Json report = object_schema(
      {{"tool", {{"const", spec.name}}},
       {"version", text},
       {"options", options},
       {"seed", common_flag_schema("seed")},
       {"inputs", list_of(object_schema({{"name", text}, {"path", text}, {"bytes", count}, {"xxh3", hash}}, {"xxh3"}))},
       {"outputs", list_of(object_schema({{"name", text}, {"path", text}}))},
       {"device", object_schema({{"kind", {{"enum", {"cpu", "cuda"}}}},
                                 {"name", text},
                                 {"reason", text},
                                 {"fast_atomics", {{"type", "boolean"}}}})},
       {"threads", common_flag_schema("threads")},
       {"isa", {{"enum", {"portable", "neon", "x86-64-v3", "x86-64-v4"}}}},
       {"dry_run", common_flag_schema("dry_run")},
       {"exit_code", {{"enum", {0, 1, 7, 130, 143}}}},
       {"stages", {{"$ref", "#/definitions/stage"}}},
       {"counts", counts},
       {"result", free_object},
       {"warnings", list_of(text)},
       {"plan", free_object}},
      {"plan"});
  Json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", spec.name + " report"}};
  schema.update(report);
  schema["definitions"] = {{"stage", stage}};
  return schema;
}

std::string stage_of_chain() {
  const char* stage = std::getenv("NGS_STAGE_OF");
  return stage == nullptr ? "" : stage;
}

std::string duration_text(double seconds) {
  char text[48];
  const long whole = std::lround(seconds);
  if (whole < 60)
    std::snprintf(text, sizeof text, seconds < 10 ? "%.1f s" : "%.0f s", seconds);
  else if (whole < 3600)
    std::snprintf(text, sizeof text, "%ld min %ld s", whole / 60, whole % 60);
  else
    std::snprintf(text, sizeof text, "%ld h %ld min", whole / 3600, whole % 3600 / 60);
  return text;
}

std::string summary_text(const Spec& spec, const Json& report) {
  if (!stage_of_chain().empty()) return chain_line(spec, report);
  std::string text = spec.name + ": " + outcome_line(report) + "\n";
  const Json& outputs = report["outputs"];
  const bool wrote_files = report["dry_run"] == false;
  for (std::size_t i = 0; wrote_files && i < std::min(kMaxOutputs, outputs.size()); ++i)
    text += "  " + output_text(outputs[i]["path"]) + "\n";
  if (wrote_files && outputs.size() > kMaxOutputs)
    text += "  and " + std::to_string(outputs.size() - kMaxOutputs) + " more\n";
  if (const std::string outcome = outcome_text(spec.name, report); !outcome.empty()) text += "  " + outcome + "\n";
  if (const std::size_t warnings = report["warnings"].size(); warnings > 0)
    text += "  " + std::to_string(warnings) + (warnings == 1 ? " warning, see above\n" : " warnings, see above\n");
  if (const std::string next = next_command(spec); wrote_files && report["exit_code"] == kDone && !next.empty())
    text += wrapped("  next: ", next, {8, terminal_columns(os::kStderr), next.starts_with("ngs") ? " \\" : ""}) + "\n";
  return text;
}

}  // namespace ngs::cli
