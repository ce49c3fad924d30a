#pragma once
// The tiny scene as a capture in its own folder, and the scripts of pipelines/ on it.
#include <doctest/doctest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/process.h"
#include "support/temp_dir.h"
#include "support/tiny_scene.h"

namespace ngs::test {

namespace fs = std::filesystem;

/// A program with the environment of the scripts, in a folder.
inline ProcessSpec script_spec(const std::string& folder, const Words& argv, const Environment& more = {}) {
  const Environment own{{"NGS_BIN", NGS_TOOL_DIR}, {"NGS_THREADS", "2"}, {"SAMPLE_FLAGS", "--rows 8 --cols 8"}};
  return {.argv = argv, .environment = joined(own, more), .folder = folder};
}

inline std::map<std::string, fs::file_time_type> times_of(const std::string& folder) {
  std::map<std::string, fs::file_time_type> times;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && entry.path().string().find("/.state/") == std::string::npos)
      times[fs::relative(entry.path(), folder).string()] = entry.last_write_time();
  return times;
}

/// A folder with the photos, poses, masks and model of the tiny scene in `name`, without scene.json.
struct ChainCapture {
  TempDir dir;
  std::string name, out = path("the output");

  explicit ChainCapture(const std::string& folder = "my scene") : name(folder) {
    fs::create_directories(path(name));
    write_tiny_scene(path(name));
    fs::remove(path(name + "/scene.json"));
  }
  std::string path(const std::string& file) const { return dir.path() + "/" + file; }
  bool has(const std::string& file) const { return fs::exists(path(file)); }
  std::string bytes(const std::string& file) const { return read_bytes(path(file)); }
  nlohmann::json json(const std::string& file) const { return nlohmann::json::parse(bytes(file), nullptr, false); }

  ProcessSpec spec(const std::string& script, const Words& arguments, const Environment& more = {}) const {
    return script_spec(dir.path(), joined({NGS_SOURCE_DIR "/pipelines/" + script}, arguments), more);
  }
  ProcessResult script(const std::string& script, const Words& arguments, const Environment& more = {}) const {
    return run_process(spec(script, arguments, more));
  }
  /// make -f pipelines/FILE WORDS...
  ProcessResult make(const std::string& file, const Words& words) const {
    return run_process(
        script_spec(dir.path(), joined({"make", "-s", "-f", NGS_SOURCE_DIR "/pipelines/" + file}, words)));
  }
  ProcessResult ngs_gs(const Words& arguments, const Environment& more = {}) const {
    return script("ngs-gs.sh", arguments, more);
  }
  /// The chain from the capture to `the output`, v2 held out, scored against the capture's own masks.
  ProcessResult run(const Words& further, const Environment& more = {}) const {
    return ngs_gs(joined({name, "the output", "--hold-out", "every:4:2", "--gt", name + "/masks"}, further), more);
  }
};

}  // namespace ngs::test
