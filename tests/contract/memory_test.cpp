// The memory that ngs-variance says it needs is what it takes, and it leaves the SH bands in the file.
#include <doctest/doctest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/scene/scene_json.h"
#include "support/random.h"
#include "support/temp_dir.h"
#include "support/tool_fixture.h"

namespace ngs {
namespace {

/// Small Gaussians in the cube that the cameras of the fixture look at.
GaussianCloud many_gaussians(std::int64_t n, int degree) {
  GaussianCloud cloud;
  cloud.resize(n, degree);
  test::Random random(5);
  for (float& p : cloud.position) p = float(random.uniform(-0.5, 0.5));
  for (std::size_t i = 0; i < std::size_t(n); ++i) cloud.rotation[i * 4] = 1;
  for (float& s : cloud.log_scale) s = -5.5f;
  return cloud;
}

nlohmann::json report_of(const std::string& scene, const std::string& folder, bool dry) {
  test::ProcessSpec spec;
  spec.argv = {NGS_TOOL_DIR "/ngs-variance", scene, "-o", folder + "/out.ply", "-w", "--allow-empty", "-q"};
  if (dry) spec.argv.push_back("--dry-run");
  const test::ProcessResult result = test::run_process(spec);
  REQUIRE(result.exit_code == 0);
  return nlohmann::json::parse(result.out);
}

}  // namespace

TEST_CASE("ngs-variance --dry-run foresees the peak memory, and SH bands do not add to it") {
  const test::TempDir folder;
  Scene scene = io::read_scene_json(test::fixture_folder() + "/scene.json");
  double peak[2];
  for (const int degree : {0, 2}) {
    const std::string name = folder.path() + "/" + std::to_string(degree);
    scene.model_path = name + ".ply";
    io::write_strict_ply(scene.model_path, many_gaussians(400000, degree), {});
    io::write_scene_json(name + ".json", scene);
    const nlohmann::json plan = report_of(name + ".json", folder.path(), true).at("plan");
    const nlohmann::json run = report_of(name + ".json", folder.path(), false);
    const double measured = peak[degree / 2] = run.at("stages").at("max_rss_mib").get<double>();
    CHECK(plan.at("gaussians") == 400000);
    CHECK(plan.at("estimated_peak_mib").get<double>() >= measured * 0.95);
    CHECK(plan.at("estimated_peak_mib").get<double>() <= measured * 1.4);
  }
  CHECK(std::abs(peak[1] - peak[0]) < 45);  // the bands themselves are 37 MiB; a part of the file is in memory
}

}  // namespace ngs
