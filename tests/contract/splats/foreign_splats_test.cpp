// Splats written by other programs.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>

#include "ngs/io/ply/gaussian_ply.h"
#include "support/process.h"
#include "support/temp_dir.h"
#include "support/tiny_scene.h"
#include "support/tool_fixture.h"

namespace ngs {
namespace {

using test::contains;

const std::string kTools = NGS_TOOL_DIR;

/// The tiny scene's model with activated values.
std::string activated_model(const test::TempDir& dir) {
  GaussianCloud cloud = test::tiny_scene().cloud;
  for (float& s : cloud.log_scale) s = std::exp(s);
  for (std::size_t i = 0; i < cloud.logit_opacity.size(); ++i)
    cloud.logit_opacity[i] = float(0.05 + 0.9 * double(i) / double(cloud.logit_opacity.size()));
  return dir.write("activated.ply", test::strict_ply_bytes(cloud));
}

std::string hint_of(const std::string& err) {
  const std::size_t at = err.find("hint: ");
  return at == std::string::npos ? "" : err.substr(at + 6, err.find('\n', at) - at - 6);
}

}  // namespace

TEST_CASE("a splat with activated values is rejected before any rendering, and the printed command converts it") {
  const test::TempDir dir;
  const std::string model = activated_model(dir), out = dir.path() + "/cut";
  for (const std::vector<std::string>& argv :
       {std::vector<std::string>{kTools + "/ngs", "cut", model, "-o", out},
        {kTools + "/ngs-clean", model, "-o", out},
        {kTools + "/ngs-extract", model, "--largest", "1", "--object-ply", out}}) {
    const test::ProcessResult result = test::refused(test::run_command(argv), 3, "scale_* all > 0");
    CHECK(contains(result.err, "opacity 0 to 1"));
    CHECK(!std::filesystem::exists(out));
  }
  const std::string hint = hint_of(test::run_command({kTools + "/ngs-clean", model, "-o", out}).err);
  CHECK(contains(test::read_bytes(NGS_SOURCE_DIR "/docs/faq.md"),
                 "`ngs-extract IN.ply --activated --object-ply OUT.ply`"));
  const std::size_t command = hint.find("ngs-extract ");
  REQUIRE(command != std::string::npos);
  const test::ProcessResult converted = test::succeeded(test::run_command(
      {"bash", "-c", "cd " + dir.path() + " && PATH=" + kTools + ":$PATH && " + hint.substr(command)}));
  const GaussianCloud cloud = io::read_gaussian_ply(dir.path() + "/converted.ply").cloud,
                      first = test::tiny_scene().cloud;
  REQUIRE(cloud.size() == first.size());
  for (std::size_t i = 0; i < cloud.log_scale.size(); ++i)
    CHECK(cloud.log_scale[i] == doctest::Approx(first.log_scale[i]).epsilon(1e-5));
  CHECK(cloud.logit_opacity[0] == doctest::Approx(std::log(0.05 / 0.95)).epsilon(1e-5));
}

}  // namespace ngs
