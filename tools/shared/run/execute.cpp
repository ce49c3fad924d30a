#include "shared/run/execute.h"

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/ops/device/cuda_ops.h"
#include "ngs/options/option_warnings.h"
#include "ngs/os/process_usage.h"
#include "shared/cli/command_line.h"
#include "shared/cli/exit_code.h"
#include "shared/os/files.h"
#include "shared/os/machine.h"
#include "shared/run/paths.h"
#include "shared/run/report.h"
#include "shared/run/run_state.h"
#include "shared/run/signals.h"

namespace ngs::cli {
namespace {

namespace fs = std::filesystem;

/// Files that an earlier run left in an output folder and that a run with -w did not replace. They could be mistaken
/// for its results.
class StaleOutputs {
 public:
  /// Lists the files in the folder before the run; none if the folder does not exist.
  explicit StaleOutputs(std::string folder) : folder_(std::move(folder)), before_(files_in(folder_)) {}

  const std::string& folder() const { return folder_; }
  /// Sorted names, relative to the folder, of unchanged files whose extension the run has written too.
  std::vector<std::string> untouched() const {
    if (before_.empty()) return {};
    const Files now = files_in(folder_);
    const auto is_old = [&](const std::string& name) {
      const auto old = before_.find(name), found = now.find(name);
      return old != before_.end() && found != now.end() && old->second == found->second;
    };
    std::set<fs::path> kinds;  // extensions that the run has written
    for (const auto& [name, file] : now)
      if (!is_old(name)) kinds.insert(fs::path(name).extension());
    std::vector<std::string> names;
    for (const auto& [name, file] : before_)
      if (is_old(name) && kinds.contains(fs::path(name).extension())) names.push_back(name);
    return names;
  }

 private:
  using Files = std::map<std::string, os::FileVersion>;
  static Files files_in(const std::string& folder) {
    Files files;
    std::error_code failed;
    for (fs::recursive_directory_iterator entry(folder, failed), end; !failed && entry != end;
         entry.increment(failed)) {
      const os::FileVersion version = os::version_of_file(entry->path().generic_string());
      if (version.inode != 0) files[entry->path().lexically_relative(folder).generic_string()] = version;
    }
    return files;
  }

  std::string folder_;
  Files before_;
};

void choose_device_and_threads(RunState& state) {
  state.exec.threads = choose_threads(state.flags.threads);
  state.exec.isa = choose_isa();
  state.exec.device = state.device.device;
  if (state.device.device == Device::kCuda) state.exec.device_ops = cuda_ops();
  state.console.info("device: " + state.device.name + " (" + state.device.reason +
                     "), threads: " + std::to_string(state.exec.threads) + ", " + isa_name(state.exec.isa));
}

void connect(Monitor& monitor, Console& console) {
  monitor.stop_flag(&stop_flag());
  monitor.on_warning = [&](const std::string& message) { console.warning(message); };
  monitor.on_progress = [&](const std::string& stage, std::int64_t done, std::int64_t total) {
    console.progress(stage, done, total);
  };
  monitor.on_stage_end = [&](const std::string& stage) { console.stage_ended(stage); };
}

void hash_inputs(RunState& state) {
  const Monitor::Scope scope = state.monitor.scope("hash inputs");
  state.inputs = describe_inputs(state.spec, !state.flags.dry_run);
  for (ReadInput& input : state.inputs) input.path = state.streams.given(input.path);
}

/// Creates the output folders and the parent folders of output files; if the body fails, removes those that are empty.
/// Also finds files of earlier runs in output folders.
class OutputFolders {
 public:
  explicit OutputFolders(const RunState& state) {
    if (state.flags.dry_run) return;
    for (const Output& output : state.spec.outputs)
      if (output && output.directory && !output.resumes) {
        create(output.path);
        folders_.emplace_back(output.path);
      } else if (output && !output.directory) {
        create(std::filesystem::path(output.path).parent_path().generic_string());
      }
    create(std::filesystem::path(state.flags.report_path).parent_path().generic_string());
  }
  void remove_empty() const {
    std::error_code not_empty;
    for (auto folder = created_.rbegin(); folder != created_.rend(); ++folder)
      std::filesystem::remove(*folder, not_empty);
  }
  void warn_of_stale_outputs(Monitor& monitor) const {
    for (const StaleOutputs& folder : folders_)
      if (const std::vector<std::string> names = folder.untouched(); !names.empty())
        monitor.warn(folder.folder() + ": contains " + std::to_string(names.size()) +
                     (names.size() == 1 ? " file" : " files") + " of an earlier run (first: " + names.front() +
                     "). To avoid mixing runs, remove the folder and repeat.");
  }

 private:
  void create(const std::string& folder) {
    if (folder.empty()) return;
    const std::vector<std::string> created = create_folders(folder);
    created_.insert(created_.end(), created.begin(), created.end());
  }

  std::vector<StaleOutputs> folders_;
  std::vector<std::string> created_;
};

int run_body(RunState& state, const std::function<int(Run&)>& body) {
  const OutputFolders folders(state);
  try {
    const int exit_code = run_on_device_or_cpu(state, body);
    folders.warn_of_stale_outputs(state.monitor);
    return exit_code;
  } catch (...) {
    folders.remove_empty();
    throw;
  }
}

Json report_of(const RunState& state, double wall_s, int exit_code) {
  return make_report({.spec = state.spec,
                      .flags = state.flags,
                      .streams = state.streams,
                      .device = state.device,
                      .threads = state.exec.threads,
                      .isa = state.exec.isa,
                      .inputs = state.inputs,
                      .monitor = state.monitor,
                      .result = state.result,
                      .plan = state.plan,
                      .wall_s = wall_s,
                      .cpu_s = os::cpu_seconds(),
                      .exit_code = exit_code});
}

}  // namespace

int run_on_device_or_cpu(RunState& state, const std::function<int(Run&)>& body) {
  Run run(state);
  const std::vector<ReadInput> inputs = state.inputs;
  try {
    return body(run);
  } catch (const OutOfDeviceMemory& e) {
    state.leave_device(e, "the run");
  }
  state.inputs = inputs;
  state.result = Json::object();
  state.plan = Json::object();
  state.is_restart = true;
  return body(run);
}

int execute(Spec& spec, const CommonFlags& flags, Console& console, const std::function<int(Run&)>& body) {
  const double start_s = wall_seconds();
  install_signal_handlers(spec.stops_on_request);
  check_required(spec, flags.dry_run);
  check_outputs(spec, flags.report_path, flags.overwrite);
  const Streams streams(spec);
  check_inputs(spec);
  RunState state{.spec = spec,
                 .streams = streams,
                 .flags = flags,
                 .console = console,
                 .device = choose_device(flags.device, spec)};
  choose_device_and_threads(state);
  connect(state.monitor, console);
  for (const std::string& warning : flags.warnings) state.monitor.warn(warning);
  for (const std::string& warning : unused_group_warnings(spec.options)) state.monitor.warn(warning);
  hash_inputs(state);
  const int exit_code = run_body(state, body);

  cancel_grace_timer();
  console.clear_progress();
  const Json report = report_of(state, wall_seconds() - start_s, exit_code);
  streams.copy_output();
  if (!flags.report_path.empty()) io::write_file(flags.report_path, json_document(report));
  const bool by_default = !spec.reports_on_request && flags.report_path.empty() && !streams.to_stdout();
  if (flags.json || (by_default && !os::is_terminal(os::kStdout))) print_json(report);
  if (exit_code < kInterrupted) console.summary(summary_text(spec, report));
  return exit_code;
}

}  // namespace ngs::cli
