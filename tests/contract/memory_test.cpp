// The memory that ngs-variance and ngs-joint say they need is what they take, and SH bands stay in the file.
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

using Words = std::vector<std::string>;

nlohmann::json report_of(const Words& command, const Words& flags = {}) {
  test::ProcessSpec spec;
  spec.argv = command;
  spec.argv.insert(spec.argv.end(), {"-w", "--allow-empty", "-q"});
  spec.argv.insert(spec.argv.end(), flags.begin(), flags.end());
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
    const Words command{NGS_TOOL_DIR "/ngs-variance", name + ".json", "-o", folder.path() + "/out.ply"};
    const nlohmann::json plan = report_of(command, {"--dry-run"}).at("plan");
    const nlohmann::json run = report_of(command);
    const double measured = peak[degree / 2] = run.at("stages").at("max_rss_mib").get<double>();
    CHECK(plan.at("gaussians") == 400000);
    CHECK(plan.at("estimated_peak_mib").get<double>() >= measured * 0.95);
    CHECK(plan.at("estimated_peak_mib").get<double>() <= measured * 1.4);
  }
  CHECK(std::abs(peak[1] - peak[0]) < 45);  // the bands themselves are 37 MiB; a part of the file is in memory
}

TEST_CASE("ngs-joint --dry-run foresees the peak memory of a draft") {
  const test::TempDir folder;
  Scene scene = io::read_scene_json(test::fixture_folder() + "/scene.json");
  scene.model_path = folder.path() + "/model.ply";
  io::write_strict_ply(scene.model_path, many_gaussians(400000, 0), {});
  const std::string json = folder.path() + "/scene.json", boundary = folder.path() + "/boundary.ply";
  io::write_scene_json(json, scene);
  report_of({NGS_TOOL_DIR "/ngs-variance", json, "-o", boundary});
  const Words command{NGS_TOOL_DIR "/ngs-joint",  json,        boundary, "-o",
                      folder.path() + "/out.ply", "--quality", "draft"};
  const nlohmann::json plan = report_of(command, {"--dry-run"}).at("plan");
  const double measured = report_of(command).at("stages").at("max_rss_mib").get<double>(),
               foreseen = plan.at("estimated_peak_mib").get<double>();
  CHECK(plan.at("bytes_per_gaussian").get<double>() > 165);
  CHECK(foreseen >= measured * 0.9);
  CHECK(foreseen <= measured * 1.6);
}

}  // namespace ngs
