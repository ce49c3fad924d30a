// The memory estimates of ngs-variance and ngs-joint match the real peak; ngs-variance does not load the SH bands.
#include <doctest/doctest.h>

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

/// The report of the command `words`, or of its dry run.
nlohmann::json report_of(Words words, bool dry) {
  for (const char* word : {"-w", "--allow-empty", "-q"}) words.emplace_back(word);
  if (dry) words.emplace_back("--dry-run");
  const test::ProcessResult result = test::succeeded(test::run_command(std::move(words)));
  return nlohmann::json::parse(result.out);
}

/// Writes the fixture's scene with many Gaussians; returns the path of its scene.json.
std::string large_scene(const std::string& folder, int degree) {
  Scene scene = io::read_scene_json(test::fixture_folder() + "/scene.json");
  const std::string name = folder + "/" + std::to_string(degree);
  scene.model_path = name + ".ply";
  io::write_strict_ply(scene.model_path, many_gaussians(400000, degree), {});
  io::write_scene_json(name + ".json", scene);
  return name + ".json";
}

double peak_mib(const nlohmann::json& run) { return run.at("stages").at("max_rss_mib").get<double>(); }

}  // namespace

TEST_CASE("ngs-variance --dry-run estimates the peak memory, and SH bands do not add to it") {
  const test::TempDir folder;
  double peak[2];
  for (const int degree : {0, 2}) {
    const Words words{NGS_TOOL_DIR "/ngs-variance", large_scene(folder.path(), degree), "-o",
                      folder.path() + "/out.ply"};
    const nlohmann::json plan = report_of(words, true).at("plan");
    const double measured = peak[degree / 2] = peak_mib(report_of(words, false));
    CHECK(plan.at("gaussians") == 400000);
    CHECK(plan.at("estimated_peak_mib").get<double>() >= measured * 0.95);
    CHECK(plan.at("estimated_peak_mib").get<double>() <= measured * 1.4);
  }
  CHECK(std::abs(peak[1] - peak[0]) < 45);  // the bands are 37 MiB; part of the mapped file is in memory
}

TEST_CASE("ngs-joint --dry-run estimates the peak memory, without and with steps") {
  const test::TempDir folder;
  const std::string scene = large_scene(folder.path(), 1), boundary = folder.path() + "/boundary.ply";
  report_of({NGS_TOOL_DIR "/ngs-variance", scene, "-o", boundary}, false);
  for (const bool steps : {false, true}) {
    CAPTURE(steps);
    Words words{NGS_TOOL_DIR "/ngs-joint", scene, boundary, "-o", folder.path() + "/out.ply", "--quality", "draft"};
    for (const std::string& word : Words{"--effect", steps ? "joint=on" : "joint=off", "--effect", "mask-outliers=on",
                                         "--effect", "floaters=on", "--effect", "contours=off"})
      words.push_back(word);
    const nlohmann::json plan = report_of(words, true).at("plan");
    const double estimated = plan.at(steps ? "estimated_peak_mib_with_steps" : "estimated_peak_mib").get<double>(),
                 measured = peak_mib(report_of(words, false));
    CAPTURE(estimated);
    CAPTURE(measured);
    CHECK(estimated >= measured * 0.95);
    CHECK(estimated <= measured * 1.6);
  }
}

}  // namespace ngs
