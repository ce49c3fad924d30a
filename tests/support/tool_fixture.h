#pragma once
// The fixture of the contract tests, and calls of the tools.
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/process.h"

namespace ngs::test {

/// `json` with `from` replaced by `to` in every text.
nlohmann::json with_text(const nlohmann::json& json, const std::string& from, const std::string& to);

/// `json` with {tmp}, {fixture} and {tools} replaced in every text.
nlohmann::json resolved(const nlohmann::json& json, const std::string& tmp, const std::string& fixture);

/// The folder of the built tools, or NGS_WINDOWS_TOOLS: scripts with their names that run the Windows tools
/// (ci/windows-archive.sh).
std::string tool_folder();

/// The folders of tools/ that are tools, sorted: "ngs", "ngs-clean", ...
Words tool_names();
/// Every command line with options of its own: {"ngs", "cut"}, {"ngs-rbf"}, {"ngs-scene", "import"}, ...
std::vector<Words> tool_commands();

std::vector<std::string> words(const nlohmann::json& list);

/// Runs argv, with the built tool as its first word, on two threads.
ProcessSpec command(const nlohmann::json& run);

/// The same with a file size limit of `kib` KiB.
ProcessSpec with_files_of_at_most(int kib, ProcessSpec spec);

/// A folder made once per process: the tiny scene (tiny_scene.h), and the artifacts that the tools make from it
/// (contract/fixture.json, in order). Read-only.
const std::string& fixture_folder();

}  // namespace ngs::test
