#include "shared/run/summary.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <utility>
#include <vector>

#include "ngs/core/formatted.h"
#include "ngs/io/files/shell_word.h"
#include "shared/cli/exit_code.h"
#include "shared/os/machine.h"
#include "shared/text/layout.h"

namespace ngs::cli {
namespace {

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
