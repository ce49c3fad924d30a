#include "stage_runner.h"

#include <algorithm>
#include <filesystem>
#include <limits>

#include "ngs/backend/device_info.h"
#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/json_file.h"
#include "ngs/options/name_of.h"
#include "shared/cli/exit_code.h"
#include "shared/os/machine.h"
#include "shared/run/child_process.h"
#include "shared/run/console.h"
#include "shared/run/environment.h"
#include "shared/run/signals.h"

namespace ngs::ngs_tool {
namespace {

namespace fs = std::filesystem;

/// A tool that does not end within this time after a signal is killed; ngs cut must end within one second.
constexpr double kGrace_s = 0.7;

/// Removes unfinished files of a tool that had to be killed.
void remove_unfinished(const std::string& folder) {
  std::error_code failed;
  std::vector<fs::path> found;
  for (fs::recursive_directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with(".ngs-") && name.find(".tmp") != name.npos) found.push_back(entry->path());
  }
  for (const fs::path& path : found) fs::remove(path, failed);
}

}  // namespace

StageRunner::StageRunner(cli::Run& run, std::string folder, int threads, std::set<std::string> own_flags)
    : run_(run), folder_(std::move(folder)), threads_(threads), own_flags_(std::move(own_flags)) {
  run_.monitor().on_progress = [this](const std::string&, std::int64_t done, std::int64_t total) {
    show_progress(done, total);
  };
}

StageRunner::~StageRunner() { run_.monitor().on_progress = nullptr; }

void StageRunner::plan(std::vector<PlannedStep> steps) {
  const bool same = steps.size() == steps_.size();
  steps_ = std::move(steps);
  if (same) return;
  step_ = 0;
  std::vector<cli::ChainStep> parts;
  for (const PlannedStep& step : steps_) parts.push_back({step.share, step.has_passes});
  clock_ = cli::ChainClock(std::move(parts));
}

void StageRunner::begin(const std::string& name) {
  const auto found = std::ranges::find(steps_, name, &PlannedStep::name);
  if (found == steps_.end()) return;
  step_ = std::size_t(found - steps_.begin());
  clock_.begin(step_, wall_seconds());
  show_progress(0, 0);
}

void StageRunner::show_progress(std::int64_t done, std::int64_t total) {
  if (step_ >= steps_.size()) return;
  if (total > 0) clock_.update(double(done) / double(total));
  const double now_s = wall_seconds();
  run_.progress({steps_[step_].about, step_ + 1, steps_.size(), clock_.done(now_s), clock_.left_s(now_s)});
}

bool StageRunner::names_flag_of_stage(const std::string& text) const {
  for (std::size_t at = text.find("--"); at != text.npos; at = text.find("--", at + 2)) {
    const std::size_t end = text.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-_", at);
    const std::string flag = text.substr(at, end - at);
    const std::string positive = flag.starts_with("--no-") ? "--" + flag.substr(5) : flag;
    const bool of_another = flag.find('_') != flag.npos || text.rfind("ngs-", at) != text.npos;
    if (!of_another && !own_flags_.contains(flag) && !own_flags_.contains(positive)) return true;
  }
  return false;
}

std::string StageRunner::hint_for(const PlannedStep& step) const {
  if (!names_flag_of_stage(hint_)) return hint_;
  const std::string command = step.command[0] == "ngs-scene" ? "ngs-scene " + step.command[1] : step.command[0];
  return command + ": " + hint_ + "; the command was " + cli::quoted_line(full_command(step));
}

const nlohmann::json& StageRunner::report(const std::string& name) const {
  static const nlohmann::json none;
  const auto found = std::find(names_.rbegin(), names_.rend(), name);
  return found == names_.rend() ? none : results_[std::size_t(names_.rend() - found - 1)].report;
}

void StageRunner::on_output_line(const std::string& line) {
  const nlohmann::json record = nlohmann::json::parse(line, nullptr, false);
  if (!record.is_object() || !record.contains("event")) return;
  const std::string event = record.value("event", ""), message = record.value("message", "");
  if (event == "progress") show_progress(record.value("done", 0), record.value("total", 0));
  if (event == "error") error_ = message;
  if (event == "hint") hint_ = message;
  if (event == "warning") warnings_.push_back(record.value("tool", "") + ": " + message);
}

Words StageRunner::full_command(const PlannedStep& step) const {
  Words words = step.command;
  words.insert(words.end(), {"-w", "-j", std::to_string(threads_), "--seed", std::to_string(run_.seed()), "--report",
                             report_path(step)});
  if (const cli::DeviceChoice device = run_.device_choice();
      device != cli::DeviceChoice::kAuto && cli::has_device_path(words[0]))
    words.insert(words.end(), {"--device", std::string(name_of(cli::kDevices, device))});
  return words;
}

Words StageRunner::commands() const {
  Words lines;
  for (const PlannedStep& step : steps_)
    if (!step.command.empty()) lines.push_back(cli::quoted_line(full_command(step)));
  return lines;
}

bool StageRunner::run(const PlannedStep& step) {
  if (run_.monitor().stop_requested()) return false;
  const Words words = full_command(step);
  fs::create_directories(folder_ + "/reports");
  io::write_file(folder_ + "/reports/" + step.name + ".sh", cli::quoted_line(words) + "\n");
  std::error_code absent;
  fs::remove(report_path(step), absent);  // of an earlier run
  Words argv = cli::sibling_command(words);
  argv.insert(argv.end(), {"--log-format", "json"});

  const auto timed = run_.monitor().scope(step.name);
  begin(step.name);
  os::set_variable("NGS_PROGRESS_S", "0.3", true);  // short enough to update the progress of ngs cut
  if (run_.exec().device == Device::kCuda) release_freed_device_memory();  // the stage needs it
  const double start_s = wall_seconds();
  error_.clear();
  hint_.clear();
  const std::size_t earlier = warnings_.size();
  const cli::SignalGrace waits;  // until the tool has ended and removed its unfinished files
  const cli::ChildResult child =
      cli::run_child(argv, {.time_s = std::numeric_limits<double>::infinity(),
                            .stop = [this] { return run_.monitor().stop_requested(); },
                            .grace_on_stop_s = kGrace_s,
                            .on_line = [this](const std::string& line) { on_output_line(line); }});
  if (child.end == cli::ChildResult::End::kStopped) return remove_unfinished(folder_), false;
  if (child.end == cli::ChildResult::End::kSignalled) {
    remove_unfinished(folder_);
    throw Error(ErrorCode::kEnvironment, words[0] + ": ended by signal " + std::to_string(child.code),
                child.code == 9 ? "possibly out of memory: estimate it with --dry-run of the tool" : "");
  }
  if (child.code != cli::kDone && child.code != cli::kBudgetHit && !fs::exists(report_path(step), absent) &&
      error_.empty())
    throw Error(ErrorCode::kEnvironment, words[0] + ": ended without a report: " + child.output_tail,
                "the system may limit processes, threads or memory: ulimit -a");
  if (child.code != cli::kDone && child.code != cli::kCheckFailed && child.code != cli::kBudgetHit) {
    for (std::size_t i = earlier; i < warnings_.size(); ++i) run_.monitor().warn(warnings_[i]);
    throw Error(ErrorCode(child.code), words[0] + ": " + (error_.empty() ? child.output_tail : error_), hint_for(step));
  }
  names_.push_back(step.name);
  results_.push_back({words[0], wall_seconds() - start_s, io::read_json_file(report_path(step))});
  return true;
}

}  // namespace ngs::ngs_tool
