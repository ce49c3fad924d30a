// Widely used programs open the outputs of the tools. A case whose program is missing is skipped:
//   splat-transform   npm install -g @playcanvas/splat-transform@3.7.0
//   oiiotool          Debian's openimageio-tools
#include <doctest/doctest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/skip.h"
#include "support/temp_dir.h"
#include "support/tool_fixture.h"

namespace ngs {
namespace {

/// True if `program` can be started; otherwise the case is skipped.
bool present(const std::string& program) {
  if (test::run_command({"sh", "-c", "command -v " + program}).exit_code == 0) return true;
  test::skip(program + " is absent");
  return false;
}

std::int64_t gaussians_in(const std::string& ply) {
  const test::ProcessResult info = test::run_command({"splat-transform", "-q", ply, "--info", "json", "null"});
  CAPTURE(info.err);
  REQUIRE(info.exit_code == 0);
  return nlohmann::json::parse(info.out).at("numGaussians").get<std::int64_t>();
}

}  // namespace

TEST_CASE("splat-transform opens every model that the tools write, with the right count") {
  if (!present("splat-transform")) return;
  const std::string& fixture = test::fixture_folder();
  const std::int64_t all = gaussians_in(fixture + "/model.ply");
  for (const char* labelled : {"boundary.ply", "labelled.ply", "decided.ply", "edit_me.ply"}) {
    CAPTURE(labelled);
    CHECK(gaussians_in(fixture + "/" + labelled) == all);
  }
  CHECK(gaussians_in(fixture + "/object.ply") + gaussians_in(fixture + "/background.ply") == all);
}

TEST_CASE("splat-transform filters the object of the labelled model by its label column") {
  if (!present("splat-transform")) return;
  const test::TempDir tmp;
  const std::string& fixture = test::fixture_folder();
  const test::ProcessResult cut = test::run_command(
      {"splat-transform", "-q", "-w", fixture + "/decided.ply", "-V", "ngs_label,gte,0.5", tmp.path() + "/cut.ply"});
  REQUIRE(cut.exit_code == 0);
  CHECK(gaussians_in(tmp.path() + "/cut.ply") == gaussians_in(fixture + "/object.ply"));
}

TEST_CASE("oiiotool finds the named layers in every EXR, and no NaN or infinity") {
  if (!present("oiiotool")) return;
  int files = 0;
  for (const char* folder : {"layers", "evidence"})
    for (const auto& entry : std::filesystem::directory_iterator(test::fixture_folder() + "/" + folder)) {
      const test::ProcessResult stats =
          test::run_command({"oiiotool", "-v", "--info", "--stats", entry.path().string()});
      CAPTURE(entry.path().filename().string());
      CAPTURE(stats.out);
      REQUIRE(stats.exit_code == 0);
      CHECK(stats.out.find("ngs.mask") != std::string::npos);
      for (const char* line : {"NanCount:", "InfCount:"}) {
        const std::size_t at = stats.out.find(line);
        REQUIRE(at != std::string::npos);
        const std::string counts = stats.out.substr(at + 9, stats.out.find('\n', at) - at - 9);
        CHECK(counts.find_first_not_of(" 0") == std::string::npos);
      }
      ++files;
    }
  CHECK(files > 0);
}

}  // namespace ngs
