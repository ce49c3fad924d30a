#include "shared/run/execute.h"

#include <doctest/doctest.h>

#include "ngs/core/error.h"
#include "shared/run/checkpoints.h"
#include "shared/run/run_state.h"
#include "support/error_code.h"

namespace ngs::cli {
namespace {

/// A run on a device with 1 MiB of free memory.
struct DeviceRun {
  Spec spec;
  Streams streams{spec};
  CommonFlags flags;
  Console console{"ngs-test", LogLevel::kError, LogFormat::kText};
  RunState state{.spec = spec,
                 .streams = streams,
                 .flags = flags,
                 .console = console,
                 .device = {Device::kCuda, "a GPU", "auto", double(1 << 20)},
                 .exec = {.device = Device::kCuda, .threads = 3}};
  std::vector<std::string> warnings;

  explicit DeviceRun(DeviceChoice choice) {
    flags.device = choice;
    state.monitor.on_warning = [this](const std::string& warning) { warnings.push_back(warning); };
  }
};

/// Needs more memory than the device has.
int body(Run& run) {
  run.result()["devices"].push_back(run.exec().device == Device::kCuda ? "cuda" : "cpu");
  if (run.exec().device == Device::kCuda)
    with_context("step 3", [] { throw OutOfDeviceMemory("device memory: 5 MiB more are not available"); });
  return run.is_restart() ? 0 : 1;
}

}  // namespace

TEST_CASE("a body that runs out of the device's memory runs again on the CPU if auto chose the device") {
  DeviceRun run(DeviceChoice::kAuto);
  CHECK(run_on_device_or_cpu(run.state, body) == 0);
  CHECK(run.state.result["devices"] == Json({"cpu"}));  // nothing is left of the first attempt
  CHECK(run.state.device.device == Device::kCpu);
  CHECK(run.state.device.reason == "auto: a GPU has too little memory");
  CHECK(run.state.exec.threads == 3);
  REQUIRE(run.warnings.size() == 1);
  CHECK(run.warnings[0] == "step 3: device memory: 5 MiB more are not available: the run starts again on the CPU");
}

TEST_CASE("a body that runs out of the device's memory fails with code 8 if the user chose the device or atomic sums") {
  DeviceRun chosen(DeviceChoice::kCuda), atomic(DeviceChoice::kAuto);
  atomic.state.device.sums = DeviceSums::kAtomic;
  for (DeviceRun* run : {&chosen, &atomic}) {
    const Error e = test::thrown_by([&] { run_on_device_or_cpu(run->state, body); });
    CHECK(int(e.code()) == 8);
    CHECK(e.remedy().find("--device cpu") != std::string::npos);
    CHECK(run->warnings.empty());
  }
}

TEST_CASE("a part of a body that runs out of the device's memory runs again alone, and the rest stays on the CPU") {
  DeviceRun run(DeviceChoice::kAuto), chosen(DeviceChoice::kCuda);
  int whole = 0, part = 0;
  const auto with_a_part = [&](Run& r) {
    ++whole;
    r.on_device_or_cpu([&] {
      ++part;
      if (r.exec().device == Device::kCuda) throw OutOfDeviceMemory("device memory: too little");
    });
    return r.exec().device == Device::kCpu ? r.on_device_or_cpu([&] { return int(r.is_restart()); }) : 1;
  };
  CHECK(run_on_device_or_cpu(run.state, with_a_part) == 0);
  CHECK(whole == 1);
  CHECK(part == 2);
  CHECK(run.warnings == std::vector<std::string>{"device memory: too little: this step starts again on the CPU"});
  CHECK_THROWS_AS(run_on_device_or_cpu(chosen.state, with_a_part), OutOfDeviceMemory);
  CHECK(part == 3);
}

TEST_CASE("with auto, a model that is too large for the device's free memory stays on the CPU") {
  DeviceRun small(DeviceChoice::kAuto), large(DeviceChoice::kAuto), chosen(DeviceChoice::kCuda);
  Run(small.state).needs_device_memory(1 << 20);
  CHECK(small.state.exec.device == Device::kCuda);
  Run(large.state).needs_device_memory(3 << 20);
  CHECK(large.state.exec.device == Device::kCpu);
  CHECK(large.state.device.reason == "auto: a GPU has 1 MiB of free memory, expected 3");
  Run(chosen.state).needs_device_memory(3 << 20);
  CHECK(chosen.state.exec.device == Device::kCuda);
}

TEST_CASE("options without a device path use the CPU with auto, and fail with --device cuda") {
  DeviceRun by_auto(DeviceChoice::kAuto), chosen(DeviceChoice::kCuda);
  Run(by_auto.state).needs_cpu("no path");
  CHECK(by_auto.state.exec.device == Device::kCpu);
  CHECK_THROWS_WITH_AS(Run(chosen.state).needs_cpu("no path"), "--device cuda: no path", Error);
}

}  // namespace ngs::cli

namespace ngs {

TEST_CASE("a state that is kept already is not written again when the run stops") {
  Monitor monitor;
  cli::Checkpoints checkpoints(monitor);
  int written = 0;
  const auto write = [&] { ++written; };
  const auto fail = [] { throw Error(ErrorCode::kEnvironment, "disk: full, expected room"); };

  checkpoints.write_during_run(5, write);
  checkpoints.write_on_stop(5, write);
  CHECK(written == 1);
  checkpoints.write_on_stop(6, write);
  CHECK(written == 2);
  checkpoints.write_on_stop(6, write);
  CHECK(written == 2);

  SUBCASE("one that could not be written is tried again, and its failure is told") {
    checkpoints.write_during_run(10, fail);
    CHECK_THROWS_AS(checkpoints.write_on_stop(10, fail), Error);
    checkpoints.write_on_stop(10, write);
    CHECK(written == 3);
  }
}

}  // namespace ngs
