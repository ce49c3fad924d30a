// An interrupted ngs-joint, continued from its checkpoint, is the run that was never interrupted, wherever the signal
// came.
#include <doctest/doctest.h>
#include <signal.h>

#include <filesystem>
#include <fstream>

#include "support/temp_dir.h"
#include "support/tool_fixture.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Words = std::vector<std::string>;

struct Case {
  test::TempDir dir;
  std::string keep = dir.path() + "/keep", kept = keep + "/checkpoint.safetensors";
  std::string scene = test::fixture_folder() + "/scene.json";

  std::string path(const std::string& name) const { return dir.path() + "/" + name + ".ply"; }
  std::string bytes(const std::string& name) const { return test::read_bytes(path(name)); }

  /// Writes NAME.ply. TERM comes once stderr holds `interrupt`, where that is given.
  test::ProcessResult joint(const std::string& name, const Words& more, const std::string& interrupt = {}) const {
    Json run = {"ngs-joint", scene, test::fixture_folder() + "/boundary.ply", "-v", "-o", path(name)};
    for (const std::string& word : more) run.push_back(word);
    test::ProcessSpec spec = test::command(run);
    if (!interrupt.empty()) spec.signal = SIGTERM, spec.signal_after = interrupt;
    return test::run_process(spec);
  }
};

Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

bool says(const test::ProcessResult& result, const std::string& text) { return result.err.find(text) != std::string::npos; }

/// Stops the run of `options` where `interrupt` is said, goes on, and compares. Returns what was said when it went on.
test::ProcessResult stop_and_resume(const Case& c, const Words& options, const std::string& interrupt, bool keeps) {
  REQUIRE(c.joint("whole", options).exit_code == 0);
  const Words kept = options + Words{"--checkpoint", c.keep};
  const test::ProcessResult stopped = c.joint("resumed", kept, interrupt);
  INFO(stopped.err);
  REQUIRE(stopped.exit_code == 128 + SIGTERM);
  CHECK_FALSE(fs::exists(c.path("resumed")));
  CHECK(fs::exists(c.kept) == keeps);
  test::ProcessResult resumed = c.joint("resumed", kept + Words{"--resume"});
  REQUIRE(resumed.exit_code == 0);
  CHECK(says(resumed, "resumed after step") == keeps);
  CHECK(c.bytes("resumed") == c.bytes("whole"));
  return resumed;
}

/// Ten steps of which a checkpoint keeps the first six.
const Words kSteps{"--steps", "10", "--effect", "nerf=off", "--effect", "edges=off"};
void keep_six(const Case& c, const Words& more = {}) {
  REQUIRE(c.joint("kept", kSteps + more + Words{"--checkpoint", c.keep, "--checkpoint-every", "6"}).exit_code == 0);
  REQUIRE(fs::exists(c.kept));
}

}  // namespace

TEST_CASE("ngs-joint that was stopped while it prepared keeps nothing, and begins anew") {
  const Case c;
  stop_and_resume(c, {"--steps", "4", "--effect", "edges=off", "--effect", "floaters=on", "--effect", "view-trust=on"}, "device", false);
}

TEST_CASE("ngs-joint that was stopped in its steps goes on with the next one") {
  const Case c;
  stop_and_resume(c, {"--steps", "400", "--effect", "nerf=off", "--effect", "edges=off"}, "step 1 begins", true);
}

TEST_CASE("ngs-joint that was stopped in the edges goes on with the edges") {
  const Case c;
  const test::ProcessResult resumed = stop_and_resume(
      c, {"--steps", "4", "--effect", "nerf=off", "--effect", "edges=on", "--edge-visits", "60"}, "edges begin", true);
  CHECK(says(resumed, "resumed after step 4"));
}

TEST_CASE("ngs-joint that goes on under a budget does all the steps that are left, and counts on") {
  const Case c;
  REQUIRE(c.joint("whole", kSteps).exit_code == 0);
  keep_six(c);
  const std::string trace = c.dir.path() + "/t.jsonl";
  const Words more{"--checkpoint", c.keep, "--resume", "--time-budget", "1h", "--trace", trace};
  REQUIRE(c.joint("resumed", kSteps + more).exit_code == 0);
  CHECK(c.bytes("resumed") == c.bytes("whole"));
  std::vector<int> steps;
  std::ifstream lines(trace);
  for (std::string line; std::getline(lines, line);) steps.push_back(Json::parse(line).at("step"));
  CHECK(steps == std::vector<int>{0, 7, 8, 9, 10});
}

}  // namespace ngs
