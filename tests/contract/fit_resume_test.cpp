// An interrupted fit, continued from its checkpoint, is the fit that was never interrupted.
#include <doctest/doctest.h>
#include <signal.h>

#include <filesystem>

#include "support/temp_dir.h"
#include "support/tool_fixture.h"

namespace ngs {
namespace {

test::ProcessResult fit(const std::string& out, const std::vector<std::string>& more, bool interrupt) {
  nlohmann::json run = {"ngs-fit", test::fixture_folder() + "/scene.json", "-o", out, "--steps", "800", "--random-points", "60",
                        "--densify-from", "5", "--densify-every", "10", "--max-gaussians", "90", "--sh-degree", "1"};
  for (const std::string& word : more) run.push_back(word);
  test::ProcessSpec spec = test::command(run);
  if (interrupt) spec.signal = SIGTERM, spec.signal_after = "random Gaussians";
  return test::run_process(spec);
}

}  // namespace

TEST_CASE("ngs-fit that was stopped by SIGTERM and resumed writes the bytes of one that was not") {
  const test::TempDir dir;
  const std::string whole = dir.path() + "/whole.ply", resumed = dir.path() + "/resumed.ply", keep = dir.path() + "/keep";
  REQUIRE(fit(whole, {}, false).exit_code == 0);
  REQUIRE(fit(resumed, {"--checkpoint", keep}, true).exit_code == 128 + SIGTERM);
  CHECK_FALSE(std::filesystem::exists(resumed));
  // Options of another run do not go on from it.
  CHECK(fit(resumed, {"--checkpoint", keep, "--resume", "--dc-lr", "0.1"}, false).exit_code == 4);
  REQUIRE(fit(resumed, {"--checkpoint", keep, "--resume"}, false).exit_code == 0);
  CHECK(test::read_bytes(resumed) == test::read_bytes(whole));
}

}  // namespace ngs
