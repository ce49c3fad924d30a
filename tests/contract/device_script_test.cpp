// tests/bench/device.sh reports a missing GPU; with stand-ins for the GPU programs its output is valid whatever fails.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "support/process.h"
#include "support/schema_check.h"
#include "support/skip.h"
#include "support/temp_dir.h"
#include "support/tiny_scene.h"
#include "support/tool_fixture.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// A folder of programs that precede those of the machine in PATH, and a folder of built executables.
struct Machine {
  test::TempDir dir;
  std::string out = dir.path() + "/out.json";

  Machine() {
    fs::create_directories(dir.path() + "/path");
    fs::create_directories(dir.path() + "/build/bin");
    program("path/nvidia-smi", "echo 'GPU 0: stand-in'");
    // Runs its arguments if it knows the options.
    program(
        "path/compute-sanitizer",
        "while [[ $1 == --* ]]; do case $1 in --tool|--error-exitcode|--kernel-name) shift 2;; *) exit 3;; esac; done; "
        "exec \"$@\"");
    program("build/bin/test_parity",
            "printf 'parity\\tstand-in\\tan op\\t0.5\\t2\\nparity\\tstand-in\\tan op\\t1.5\\t2\\n'");
    program("build/bin/ngs_device_bench",
            "echo '{\"device\": \"stand-in\", \"threads\": 1, \"copy_bytes_per_s\": 1, \"cases\": []}'");
  }
  void program(const std::string& name, const std::string& body) const {
    const std::string path = dir.path() + "/" + name;
    std::ofstream(path) << "#!/usr/bin/env bash\n" << body << "\n";
    fs::permissions(path, fs::perms::owner_all);
  }
  test::ProcessResult run(const test::Words& arguments, const test::Environment& more = {}) const {
    const test::Environment own{{"PATH", dir.path() + "/path:" + std::getenv("PATH")},
                                {"NGS_DEVICE_BUILD", dir.path() + "/build"}};
    return test::run_process({.argv = test::joined({NGS_SOURCE_DIR "/tests/bench/device.sh"}, arguments),
                              .environment = test::joined(own, more),
                              .folder = dir.path()});
  }
  /// The written report, which satisfies the schema.
  Json written() const {
    const Json report = Json::parse(test::read_bytes(out));
    CHECK(test::schema_violations(Json::parse(test::read_bytes(NGS_SOURCE_DIR "/data-schema/device.schema.json")),
                                  report) == "");
    return report;
  }
};

/// python3 writes the report. No tool needs python3; without it the case is skipped.
bool can_report() {
  const bool found = test::run_command({"sh", "-c", "command -v python3"}).exit_code == 0;
  if (!found) test::skip("no python3");
  return found;
}

bool failed(const Json& report, const std::string& step) {
  return std::find(report.at("failed").begin(), report.at("failed").end(), step) != report.at("failed").end();
}

}  // namespace

TEST_CASE("device.sh exits with 77 without a device, and with 2 without the name of its output") {
  const Machine machine;
  CHECK(machine.run({}).exit_code == 2);
  for (const char* answer : {"exit 9", "echo 'No devices found.'"}) {
    machine.program("path/nvidia-smi", answer);
    const test::ProcessResult result = machine.run({machine.out});
    CHECK(result.exit_code == 77);
    CHECK(result.out == "skipped: no device\n");
    CHECK_FALSE(fs::exists(machine.out));
  }
  machine.program("path/nvidia-smi", "echo 'GPU 0: stand-in'");
  machine.program("build/bin/test_parity", "exit 77");  // a GPU that CUDA does not support
  CHECK(machine.run({machine.out}).exit_code == 77);
  CHECK_FALSE(fs::exists(machine.out));
}

TEST_CASE("device.sh writes a valid report if everything passes") {
  if (!can_report()) return;
  const Machine machine;
  test::succeeded(machine.run({"out.json"}));
  const Json report = machine.written();
  CHECK(report.at("passed") == true);
  REQUIRE(report.at("parity").size() == 1);
  CHECK(report.at("parity")[0].at("ratio") == 1.5);  // the worst one
  CHECK(report.at("benchmark").at("device") == "stand-in");
}

TEST_CASE("device.sh writes a valid report whatever fails") {
  if (!can_report()) return;
  const Machine machine;
  machine.program("path/compute-sanitizer", "exit 9");
  machine.program("build/bin/test_parity",
                  "printf 'parity\\tstand-in\\tan op\\tinf\\t2\\nparity\\thalf a line\\n'; exit 1");
  machine.program("build/bin/ngs_device_bench", "echo '{\"device\": \"broken o'; exit 1");
  for (const char* name : {"scene", "variance", "render", "sample", "rbf"})
    fs::create_symlink(std::string(NGS_TOOL_DIR "/ngs-") + name, machine.dir.path() + "/build/bin/ngs-" + name);
  machine.program("build/bin/ngs-joint", "echo '{\"tool\":' > cpu/draft.json; exit 8");
  fs::create_directories(machine.dir.path() + "/my scene");
  fs::create_directories(machine.dir.path() + "/empty");
  test::write_tiny_scene(machine.dir.path() + "/my scene");
  fs::remove(machine.dir.path() + "/my scene/scene.json");
  const test::ProcessResult result = machine.run({"out.json", "my scene", "empty"});
  INFO(result.out << result.err);
  CHECK(result.exit_code == 1);
  const Json report = machine.written();
  CHECK(report.at("passed") == false);
  for (const char* step : {"parity", "memcheck", "racecheck", "bench", "0-my scene-cpu-draft", "1-empty-import"}) {
    CAPTURE(step);
    CHECK(failed(report, step));
  }
  CHECK_FALSE(failed(report, "0-my scene-cpu-rbf"));
  CHECK(report.at("parity")[0].at("ratio").is_null());
  CHECK(report.at("benchmark").is_null());
  int on_cpu = 0;
  for (const Json& tool : report.at("tools")) on_cpu += tool.at("device") == "cpu";
  CHECK(on_cpu == 3);  // variance, render and rbf; the reports of ngs-joint are truncated or missing
}

TEST_CASE("device.sh starts no step that does not fit into the time limit") {
  if (!can_report()) return;
  const Machine machine;
  machine.program("build/bin/test_parity", "sleep 20");
  CHECK(machine.run({machine.out}, {{"NGS_DEVICE_SECONDS", "1"}}).exit_code == 1);
  const Json report = machine.written();
  for (const Json& step : report.at("steps")) CHECK(step.at("exit") == 124);
  CHECK(report.at("steps").size() == 4);
}

}  // namespace ngs
