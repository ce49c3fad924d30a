#include "shared/run/run.h"

#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/ops/device/cuda_ops.h"
#include "ngs/options/option_warnings.h"
#include "shared/os/machine.h"
#include "shared/run/paths.h"
#include "shared/run/run_state.h"
#include "shared/run/signals.h"
#include "shared/text/layout.h"

namespace ngs::cli {
namespace {

bool is_given(const Spec& spec, const std::string& flag) {
  for (const Input& input : spec.inputs)
    if (input.name == flag) return bool(input);
  for (const Inputs& list : spec.input_lists)
    if (list.name == flag) return bool(list);
  for (const Output& output : spec.outputs)
    if (output.long_flag() == flag) return bool(output);
  for (const OptionEntry& entry : spec.options.entries())
    if (option_flag(entry.name) == flag) return entry.get() != entry.default_value;
  NGS_CHECK(false, "no option or file has the flag " + flag);
  return false;
}

}  // namespace

const Exec& Run::exec() const { return state_.exec; }
bool Run::is_restart() const { return state_.is_restart; }
void Run::sum_atomically() {
  ChosenDevice& device = state_.device;
  if (device.device == Device::kCpu)
    throw Error(ErrorCode::kUsage,
                "--fast-atomics: the run is on the CPU (" + device.reason + "), expected a CUDA device",
                "use --device cuda, or leave --fast-atomics out: it would not be faster on the CPU");
  device.sums = DeviceSums::kAtomic;
  state_.exec.device_ops = cuda_ops(device.sums);
}

void Run::needs_cpu(const std::string& why) {
  if (state_.device.device == Device::kCpu) return;
  if (state_.flags.device == DeviceChoice::kCuda)
    throw Error(ErrorCode::kEnvironment, "--device cuda: " + why, "use --device cpu");
  state_.use_cpu(why);
}

void Run::needs_device_memory(double bytes) {
  const ChosenDevice& device = state_.device;
  if (device.device == Device::kCpu || state_.flags.device == DeviceChoice::kCuda || bytes <= device.free_bytes) return;
  const auto mib = [](double of) { return std::to_string(std::int64_t(of / (1 << 20))); };
  state_.use_cpu(device.name + " has " + mib(device.free_bytes) + " MiB of free memory, expected " + mib(bytes));
}
void Run::leave_device(const OutOfDeviceMemory& e) { state_.leave_device(e, "this step"); }
DeviceChoice Run::device_choice() const { return state_.flags.device; }
Monitor& Run::monitor() { return state_.monitor; }
std::uint64_t Run::seed() const { return state_.flags.seed; }
bool Run::dry_run() const { return state_.flags.dry_run; }
bool Run::allow_empty() const { return state_.flags.allow_empty; }
bool Run::overwrite() const { return state_.flags.overwrite; }
bool Run::goes_to_stdout(const Output& output) const { return state_.streams.given(output.path) == "-"; }
bool Run::comes_from_stream(const std::string& path) const { return state_.streams.given(path) != path; }
Json& Run::result() { return state_.result; }
void Run::plan(Json plan) { state_.plan = std::move(plan); }
void Run::progress(const ChainProgress& chain) { state_.console.progress(chain); }
void Run::info(const std::string& message) { state_.console.info(message); }
void Run::text(const std::string& lines) { state_.console.text(lines); }
void Run::needed(const std::string& lines) { state_.console.needed(lines); }
void Run::verbatim(const std::string& lines) { state_.console.verbatim(lines); }
int Run::columns() const { return os::is_terminal(os::kStderr) ? terminal_columns(os::kStderr) : 0; }
int Run::stop_code() const { return signal_exit_code(); }

void Run::add_input(const std::string& name, const std::string& path) {
  refuse_outputs_over(state_.spec, state_.flags.report_path, name, path);
  state_.inputs.push_back(describe_input(name, path, !dry_run()));
}

void Run::nothing_found(const std::string& message, const std::string& remedy) {
  if (!allow_empty())
    throw Error(ErrorCode::kNothingFound, message,
                remedy.empty() ? "accept an empty result with --allow-empty" : remedy);
  state_.monitor.warn(message);
}

void Run::warn_unused(const std::function<bool(std::string_view effect)>& is_on) {
  for (const std::string& warning : unused_effect_warnings(state_.spec.options, is_on)) state_.monitor.warn(warning);
}

void Run::warn_unused(const std::vector<std::string>& flags, const std::string& why) {
  std::string given;
  for (const std::string& flag : flags)
    if (is_given(state_.spec, flag)) given += (given.empty() ? "" : ", ") + flag;
  if (!given.empty()) state_.monitor.warn(given + ": not used " + why);
}

}  // namespace ngs::cli
