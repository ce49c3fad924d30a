// An interrupted fit, continued from its checkpoint, is the fit that was never interrupted.
#include <doctest/doctest.h>
#include <signal.h>

#include <filesystem>

#include "support/temp_dir.h"
#include "support/tool_fixture.h"

namespace ngs {
namespace {

test::ProcessSpec fit_spec(const std::string& out, const std::vector<std::string>& more, bool interrupt) {
  nlohmann::json run = {"ngs-fit", test::fixture_folder() + "/scene.json", "-o", out, "--steps", "800", "--random-points", "60",
                        "--densify-from", "5", "--densify-every", "10", "--max-gaussians", "90", "--sh-degree", "1"};
  for (const std::string& word : more) run.push_back(word);
  test::ProcessSpec spec = test::command(run);
  if (interrupt) spec.signal = SIGTERM, spec.signal_after = "random Gaussians";
  return spec;
}

test::ProcessResult fit(const std::string& out, const std::vector<std::string>& more, bool interrupt) {
  return test::run_process(fit_spec(out, more, interrupt));
}

/// Room for the model of 90 Gaussians, not for the checkpoint, which has the moments beside.
test::ProcessResult fit_on_full_disk(const std::string& out, const std::vector<std::string>& more) {
  return test::run_process(test::with_files_of_at_most(16, fit_spec(out, more, false)));
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != text.npos; at += part.size()) ++found;
  return found;
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

TEST_CASE("ngs-fit writes its model where there is no room for a checkpoint, says so once, and keeps the one before") {
  const test::TempDir dir;
  const std::string whole = dir.path() + "/whole.ply", model = dir.path() + "/m.ply", keep = dir.path() + "/keep",
                    kept = keep + "/fit.safetensors";
  REQUIRE(fit(whole, {}, false).exit_code == 0);
  const test::ProcessResult result = fit_on_full_disk(model, {"--checkpoint", keep, "--checkpoint-every", "300"});
  INFO(result.err);
  CHECK(result.exit_code == 0);
  CHECK(test::read_bytes(model) == test::read_bytes(whole));
  CHECK(count(result.err, "the checkpoint was not written") == 1);
  CHECK(count(result.err, "fit.safetensors: writing failed") == 1);
  CHECK(std::filesystem::is_empty(keep));

  REQUIRE(fit(model, {"-w", "--checkpoint", keep, "--checkpoint-every", "300"}, false).exit_code == 0);
  const std::string before = test::read_bytes(kept);
  REQUIRE(fit_on_full_disk(model, {"-w", "--checkpoint", keep, "--checkpoint-every", "300"}).exit_code == 0);
  CHECK(test::read_bytes(kept) == before);
}

TEST_CASE("ngs-fit that is stopped where there is no room for a checkpoint says that nothing was kept") {
  const test::TempDir dir;
  // At the first step the checkpoint is no larger than the model.
  const test::ProcessResult result =
      test::run_process(test::with_files_of_at_most(1, fit_spec(dir.path() + "/m.ply", {"--checkpoint", dir.path() + "/keep"}, true)));
  INFO(result.err);
  CHECK(result.exit_code == 8);
  CHECK(result.err.find("fit.safetensors: writing failed") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(dir.path() + "/m.ply"));
}

}  // namespace ngs
