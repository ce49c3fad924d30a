#pragma once
// Runs of tools that have the emulated device (emulated_device.cpp) in place of a GPU.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "support/process.h"
#include "support/temp_dir.h"
#include "support/tool_fixture.h"

namespace ngs::test {

/// What a run left behind.
struct DeviceRun {
  ProcessResult process;
  nlohmann::json report;                       // null if there is none
  std::int64_t launches = 0, allocations = 0;  // of all its processes
  std::string folder;

  std::string device() const { return report.at("device").at("name"); }
  std::string file(const std::string& name) const { return folder + "/" + name; }
};

/// The device of a run, and whether the run should use it.
struct OnDevice {
  std::string choice;  // of --device
  std::int64_t free_mib = 65536, allocations = -1;
};

/// The command line of a tool, with outputs in {tmp}; each run has an empty folder of its own.
class DeviceCase {
 public:
  explicit DeviceCase(std::string line) : line_(std::move(line)) {}

  DeviceRun run(const OnDevice& on) {
    DeviceRun result;
    result.folder = dir_.path() + "/" + std::to_string(++runs_);
    std::filesystem::create_directories(result.folder);
    ProcessSpec spec;
    std::istringstream line(resolved(line_, result.folder, fixture_folder()).get<std::string>());
    for (std::string word; line >> word;) spec.argv.push_back(word);
    spec.argv[0] = NGS_EMULATED_TOOL_DIR "/" + spec.argv[0];
    const std::string report = dir_.path() + "/report.json", traffic = dir_.path() + "/traffic";
    for (const std::string& word :
         {std::string("--device"), on.choice, std::string("--report"), report, std::string("-v")})
      spec.argv.push_back(word);
    spec.environment = {{"NGS_THREADS", "2"},
                        {"NGS_EMULATED_FREE_MIB", std::to_string(on.free_mib)},
                        {"NGS_EMULATED_ALLOCATIONS", std::to_string(on.allocations)},
                        {"NGS_EMULATED_TRAFFIC", traffic}};
    for (const std::string& old : {report, traffic}) std::filesystem::remove(old);
    result.process = run_process(spec);
    if (std::filesystem::exists(report)) result.report = nlohmann::json::parse(read_bytes(report));
    std::ifstream lines(traffic);
    for (std::int64_t launches = 0, allocations = 0; lines >> launches >> allocations;) {
      result.launches += launches;
      result.allocations += allocations;
    }
    return result;
  }
  /// A run that succeeds.
  DeviceRun done(const OnDevice& on) {
    DeviceRun result = run(on);
    INFO(result.process.err);
    REQUIRE(result.process.exit_code == 0);
    return result;
  }

 private:
  std::string line_;
  TempDir dir_;
  int runs_ = 0;
};

/// The paths of all files in a folder, relative to it. Not reports and pages: they show times.
inline std::vector<std::string> files_in(const std::string& folder) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string path = std::filesystem::relative(entry.path(), folder).generic_string();
    if (entry.is_regular_file() && path.find("reports/") == path.npos && !path.ends_with(".html"))
      files.push_back(path);
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// The same files with the same bytes; at least one.
inline void check_same_files(const DeviceRun& got, const DeviceRun& want) {
  const std::vector<std::string> files = files_in(want.folder);
  REQUIRE_FALSE(files.empty());
  CHECK(files_in(got.folder) == files);
  for (const std::string& file : files) {
    CAPTURE(file);
    const bool same = read_bytes(got.file(file)) == read_bytes(want.file(file));
    CHECK(same);
  }
}

}  // namespace ngs::test
