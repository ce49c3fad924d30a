#include "shared/tool.h"

#include <malloc.h>
#include <sys/resource.h>

#include <cstdio>
#include <filesystem>
#include <locale>
#include <new>

#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/ops/device/cuda_ops.h"
#include "ngs/options/option_warnings.h"
#include "shared/command_line.h"
#include "shared/console.h"
#include "shared/help.h"
#include "shared/leftovers.h"
#include "shared/paths.h"
#include "shared/signals.h"
#include "shared/streams.h"

namespace ngs::cli {

struct RunState {
  const Spec& spec;
  const Streams& streams;
  const CommonFlags& flags;
  Console& console;
  ChosenDevice device;
  Exec exec = {}, device_exec = {};
  Monitor monitor;
  std::vector<ReadInput> inputs;
  Json result = Json::object();
  Json plan = Json::object();
};

const Exec& Run::exec() const { return state_.exec; }
const Exec& Run::device_exec() const { return state_.device_exec; }
void Run::sum_atomically() {
  ChosenDevice& device = state_.device;
  if (device.device == Device::kCpu)
    throw Error(ErrorCode::kUsage, "--fast-atomics: the run is on the CPU (" + device.reason + "), expected a CUDA device",
                "use --device cuda, or leave --fast-atomics out: sums on the CPU are not the slower for their order");
  device.sums = DeviceSums::kAtomic;
  state_.device_exec.device_ops = cuda_ops(device.sums);
}
Monitor& Run::monitor() { return state_.monitor; }
std::uint64_t Run::seed() const { return state_.flags.seed; }
bool Run::dry_run() const { return state_.flags.dry_run; }
bool Run::allow_empty() const { return state_.flags.allow_empty; }
bool Run::overwrite() const { return state_.flags.overwrite; }
bool Run::goes_to_stdout(const Output& output) const { return state_.streams.given(output.path) == "-"; }
bool Run::comes_from_stream(const Input& input) const { return state_.streams.given(input.path) != input.path; }
Json& Run::result() { return state_.result; }
void Run::plan(Json plan) { state_.plan = std::move(plan); }
void Run::info(const std::string& message) { state_.console.info(message); }
void Run::text(const std::string& lines) { state_.console.text(lines); }
int Run::stop_code() const { return signal_exit_code(); }

void Run::add_input(const std::string& name, const std::string& path) {
  refuse_outputs_over(state_.spec, state_.flags.report_path, name, path);
  state_.inputs.push_back(describe_input(name, path, !dry_run()));
}

void Run::nothing_found(const std::string& message, const std::string& remedy) {
  if (!allow_empty())
    throw Error(ErrorCode::kNothingFound, message,
                remedy.empty() ? "--allow-empty makes this a result" : remedy);
  state_.monitor.warn(message);
}

void Run::warn_unused(const std::function<bool(std::string_view effect)>& is_on) {
  for (const std::string& warning : without_effect_warnings(state_.spec.options, is_on)) state_.monitor.warn(warning);
}

struct Tool::Impl {
  Spec spec;

  Input& add_input(std::string name, std::string help, bool required) {
    Input& input = spec.inputs.emplace_back(Input{std::move(name), std::move(help), required, {}});
    if (input.name[0] != '-') add_positional(input.name, input.path);
    return input;
  }
  void add_positional(const std::string& name, std::string& target) {
    spec.positionals.push_back(&target);
    spec.positional_names.push_back(name);
  }
  Output& add_output(std::string flags, std::string help, bool required, bool directory) {
    return spec.outputs.emplace_back(Output{std::move(flags), std::move(help), required, directory, {}});
  }
  int run(const CommonFlags& flags, Console& console, const std::function<int(Run&)>& body);
};

Tool::Tool(std::string name, std::string summary, std::initializer_list<std::string> examples)
    : impl_(std::make_unique<Impl>()) {
  impl_->spec.name = std::move(name);
  impl_->spec.summary = std::move(summary);
  impl_->spec.examples = examples;
}
Tool::~Tool() = default;

OptionSet& Tool::option_set() { return impl_->spec.options; }
const Input& Tool::input(std::string name, std::string help) {
  return impl_->add_input(std::move(name), std::move(help), true);
}
const Input& Tool::optional_input(std::string name, std::string help) {
  return impl_->add_input(std::move(name), std::move(help), false);
}
const Inputs& Tool::inputs(std::string name, std::string help) {
  return impl_->spec.input_lists.emplace_back(Inputs{std::move(name), std::move(help), {}});
}
const Argument& Tool::argument(std::string name, std::string help) {
  Argument& argument = impl_->spec.arguments.emplace_back(Argument{std::move(name), std::move(help), {}});
  impl_->add_positional(argument.name, argument.value);
  return argument;
}
const Output& Tool::output(std::string flags, std::string help) {
  return impl_->add_output(std::move(flags), std::move(help), true, false);
}
const Output& Tool::optional_output(std::string flags, std::string help) {
  return impl_->add_output(std::move(flags), std::move(help), false, false);
}
const Output& Tool::output_dir(std::string flags, std::string help) {
  return impl_->add_output(std::move(flags), std::move(help), true, true);
}
const Output& Tool::optional_output_dir(std::string flags, std::string help) {
  return impl_->add_output(std::move(flags), std::move(help), false, true);
}
void Tool::writes_nothing_if(const bool& option) { impl_->spec.writes_nothing_if.push_back(&option); }
void Tool::help(std::string text) { impl_->spec.help_texts.push_back(std::move(text)); }
void Tool::stops_on_request() { impl_->spec.stops_on_request = true; }
void Tool::runs_on_device() { impl_->spec.runs_on_device = true; }
void Tool::runs_partly_on_device() { impl_->spec.runs_on_device = impl_->spec.partly_on_device = true; }

namespace {

double process_cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void print(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
    throw Error(ErrorCode::kEnvironment, "stdout: cannot be written");
}

std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

/// True if the command line asked for a text instead of a run.
bool print_text(const Spec& spec, const CommonFlags& flags) {
  if (flags.help)
    print(help_text(spec));
  else if (flags.version)
    print(version_text(spec, flags.json));
  else if (flags.print_schema == "report")
    print(json_text(report_schema(spec)));
  else if (!flags.print_schema.empty())
    print(json_text(spec.options.schema(spec.name + " options")));
  else if (flags.print_options)
    print(json_text(spec.options.to_json()));
  else if (flags.print_commands)
    print("\n");
  else
    return false;
  return true;
}

/// The only place that turns exceptions into messages and exit codes.
int guarded(Console& console, const std::function<int()>& body) {
  try {
    return body();
  } catch (const Error& e) {
    console.error(e.what(), e.remedy());
    return int(e.code());
  } catch (const std::bad_alloc&) {
    console.error("out of memory", "--dry-run estimates what is needed");
    return int(ErrorCode::kEnvironment);
  } catch (const std::filesystem::filesystem_error& e) {
    console.error(e.what(), "");
    return int(ErrorCode::kEnvironment);
  } catch (const std::exception& e) {
    console.error(std::string("bug in ngs: ") + e.what(), "report it with the command line and --version");
    return kBug;
  }
}

/// What a run that fails has made and not filled.
void remove_empty(const std::vector<std::string>& folders) {
  std::error_code not_empty;
  for (const std::string& folder : folders) std::filesystem::remove(folder, not_empty);
}

}  // namespace

int Tool::Impl::run(const CommonFlags& flags, Console& console, const std::function<int(Run&)>& body) {
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
                 .device = choose_device(flags.device, spec),
                 .monitor = {},
                 .inputs = {}};
  const ChosenDevice& device = state.device;
  state.exec.threads = choose_threads(flags.threads);
  state.exec.isa = choose_isa();
  state.device_exec = state.exec;
  state.device_exec.device = device.device;
  if (device.device == Device::kCuda) state.device_exec.device_ops = cuda_ops();
  if (!spec.partly_on_device) state.exec = state.device_exec;
  state.monitor.stop_flag(&stop_flag());
  state.monitor.on_warning = [&](const std::string& message) { console.warning(message); };
  state.monitor.on_progress = [&](const std::string& stage, std::int64_t done, std::int64_t total) {
    console.progress(stage, done, total);
  };
  console.info("device: " + device.name + " (" + device.reason +
               "), threads: " + std::to_string(state.exec.threads) + ", " + isa_name(state.exec.isa));
  for (const std::string& warning : flags.warnings) state.monitor.warn(warning);
  for (const std::string& warning : unheard_warnings(spec.options)) state.monitor.warn(warning);
  {
    const Monitor::Scope scope = state.monitor.scope("hash inputs");
    state.inputs = describe_inputs(spec, !flags.dry_run);
    for (ReadInput& input : state.inputs) input.path = streams.given(input.path);
  }
  std::vector<Leftovers> folders;
  std::vector<std::string> made;
  for (const Output& output : spec.outputs)
    if (output && output.directory && !flags.dry_run) {
      if (std::filesystem::create_directories(output.path)) made.push_back(output.path);
      folders.emplace_back(output.path);
    }

  Run run(state);
  int exit_code = 0;
  try {
    exit_code = body(run);
  } catch (...) {
    remove_empty(made);
    throw;
  }
  for (const Leftovers& folder : folders)
    if (const std::vector<std::string> names = folder.untouched(); !names.empty())
      state.monitor.warn(folder.folder() + ": holds " + std::to_string(names.size()) + " files of before, the first is " +
                         names.front() + ": they are none of this run's (remove the folder first to be rid of them)");
  const Json report = make_report({.spec = spec,
                                   .flags = flags,
                                   .streams = streams,
                                   .device = device,
                                   .threads = state.exec.threads,
                                   .isa = state.exec.isa,
                                   .inputs = state.inputs,
                                   .monitor = state.monitor,
                                   .result = state.result,
                                   .plan = state.plan,
                                   .wall_s = wall_seconds() - start_s,
                                   .cpu_s = process_cpu_seconds(),
                                   .exit_code = exit_code});
  streams.copy_output();
  if (!flags.report_path.empty())
    io::write_file(flags.report_path, json_text(report));
  else if (!streams.to_stdout())
    print(json_text(report));
  return exit_code;
}

namespace {

/// Images and lists that come and go with every view stay mapped: no page is cleared for them twice.
void keep_freed_memory() {
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
}

}  // namespace

int Tool::run(int argc, char** argv, const std::function<int(Run&)>& body) {
  std::locale::global(std::locale::classic());
  keep_freed_memory();
  Console early(impl_->spec.name, LogLevel::kWarning, LogFormat::kText);
  CommonFlags flags;
  const int parsed = guarded(early, [&] {
    flags = parse_command_line(argc, argv, impl_->spec);
    return 0;
  });
  if (parsed != 0) return parsed;
  Console console(impl_->spec.name, flags.log_level, flags.log_format);
  return guarded(console,
                 [&] { return print_text(impl_->spec, flags) ? 0 : impl_->run(flags, console, body); });
}

}  // namespace ngs::cli
