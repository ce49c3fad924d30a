#pragma once
// What the contract tests start from, and how they call the tools.
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/process.h"

namespace ngs::test {

/// `json` with {tmp} and {fixture} replaced in every text.
nlohmann::json resolved(const nlohmann::json& json, const std::string& tmp, const std::string& fixture);

std::vector<std::string> words(const nlohmann::json& list);

/// argv with the built tool for its first word, two threads.
ProcessSpec command(const nlohmann::json& run);

/// The same on a disk that has no room for a file of more than `kib`.
ProcessSpec with_files_of_at_most(int kib, ProcessSpec spec);

/// A folder made once per process: the tiny scene (tiny_scene.h), then the artifacts that the tools make of
/// it (contract/fixture.json, in order). Not to be changed.
const std::string& fixture_folder();

}  // namespace ngs::test
