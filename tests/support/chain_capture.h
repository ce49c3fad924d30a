#pragma once
// The tiny scene as a capture in its own folder, and the chain on it.
#include <doctest/doctest.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "support/process.h"
#include "support/temp_dir.h"
#include "support/tiny_scene.h"

namespace ngs::test {

namespace fs = std::filesystem;

inline ProcessResult run_script(const std::string& folder, const Words& arguments,
                                const Environment& environment = {}) {
  return run_process({.argv = joined({NGS_SOURCE_DIR "/pipelines/ngs-gs.sh"}, arguments),
                      .environment = joined(environment, {{"NGS_BIN", NGS_TOOL_DIR}, {"NGS_THREADS", "2"}}),
                      .folder = folder});
}

inline std::map<std::string, fs::file_time_type> times_of(const std::string& folder) {
  std::map<std::string, fs::file_time_type> times;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && entry.path().string().find("/.state/") == std::string::npos)
      times[fs::relative(entry.path(), folder).string()] = entry.last_write_time();
  return times;
}

struct Capture {
  TempDir dir;
  std::string out;
  Capture() {
    fs::create_directories(dir.path() + "/my scene");
    write_tiny_scene(dir.path() + "/my scene");
    fs::remove(dir.path() + "/my scene/scene.json");
    out = dir.path() + "/the output";
  }
  /// The tiny scene with spaces in both folder names, v2 held out.
  ProcessResult run(std::vector<std::string> further,
                    std::vector<std::pair<std::string, std::string>> environment = {}) const {
    further.insert(further.begin(), {"my scene", "the output", "--hold-out", "every:4:2", "--gt", "my scene/masks"});
    return run_script(dir.path(), further, std::move(environment));
  }
};

}  // namespace ngs::test
