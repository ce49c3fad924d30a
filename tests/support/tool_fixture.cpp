#include "support/tool_fixture.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "support/temp_dir.h"
#include "support/tiny_scene.h"

namespace ngs::test {
namespace {

using Json = nlohmann::json;

std::string substituted(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != text.npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

}  // namespace

std::string tool_folder() {
  const char* const other = std::getenv("NGS_WINDOWS_TOOLS");
  return other != nullptr ? other : NGS_TOOL_DIR;
}

Json with_text(const Json& json, const std::string& from, const std::string& to) {
  if (json.is_string()) return substituted(json, from, to);
  if (!json.is_structured()) return json;
  Json copy = json;
  for (Json& item : copy) item = with_text(item, from, to);
  return copy;
}

Json resolved(const Json& json, const std::string& tmp, const std::string& fixture) {
  return with_text(with_text(with_text(json, "{tmp}", tmp), "{fixture}", fixture), "{tools}", tool_folder());
}

Words tool_names() {
  Words names;
  for (const auto& entry : std::filesystem::directory_iterator(NGS_SOURCE_DIR "/tools"))
    if (const std::string name = entry.path().filename().string(); name == "ngs" || name.starts_with("ngs-"))
      names.push_back(name);
  std::ranges::sort(names);
  return names;
}

std::vector<Words> tool_commands() {
  std::vector<Words> all;
  for (const std::string& tool : tool_names()) {
    std::istringstream lines(succeeded(run_tool({tool, "--print-commands"})).out);
    for (std::string name; std::getline(lines, name);) all.push_back(name.empty() ? Words{tool} : Words{tool, name});
  }
  return all;
}

std::vector<std::string> words(const Json& list) {
  std::vector<std::string> result;
  for (const Json& word : list) result.push_back(word.get<std::string>());
  return result;
}

ProcessSpec command(const Json& run) {
  ProcessSpec spec{.argv = words(run)};
  if (spec.argv[0] == "ngs" || spec.argv[0].rfind("ngs-", 0) == 0) spec.argv[0] = tool_folder() + "/" + spec.argv[0];
  spec.environment = {{"NGS_THREADS", "2"}};
  return spec;
}

ProcessSpec with_files_of_at_most(int kib, ProcessSpec spec) {
  const std::string limit = "ulimit -f " + std::to_string(kib) + " && exec \"$@\"";
  spec.argv.insert(spec.argv.begin(), {"/bin/bash", "-c", limit, "bash"});
  return spec;
}

const std::string& fixture_folder() {
  static const TempDir dir;
  static const bool made = [] {
    const std::string folder = dir.path();
    write_tiny_scene(folder);
    for (const Json& step :
         resolved(Json::parse(std::ifstream(NGS_SOURCE_DIR "/tests/contract/fixture.json")), folder, folder)) {
      test::succeeded(run_process(command(step["run"])));
    }
    return true;
  }();
  REQUIRE(made);
  return dir.path();
}

}  // namespace ngs::test
