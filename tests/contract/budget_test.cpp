// Limits of time and memory.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/scene/scene_json.h"
#include "support/random.h"
#include "support/skip.h"
#include "support/temp_dir.h"
#include "support/tool_fixture.h"

namespace ngs {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

/// The fixture's scene with every training view repeated `times` times.
std::string with_many_views(const test::TempDir& dir, int times) {
  Json scene = Json::parse(test::read_bytes(test::fixture_folder() + "/scene.json")), views = Json::array();
  for (const Json& view : scene.at("views"))
    for (int k = 0; k < (view.at("split") == "train" ? times : 1); ++k) {
      views.push_back(view);
      views.back()["name"] = std::to_string(k) + "_" + view.at("name").get<std::string>();
      for (const char* file : {"image", "mask"})
        if (view.contains(file))
          views.back()[file] = fs::absolute(fs::path(test::fixture_folder()) / view[file].get<std::string>());
    }
  scene["views"] = views;
  scene["model"] = test::fixture_folder() + "/model.ply";
  std::string path = dir.path() + "/many.json";
  std::ofstream(path) << scene.dump();
  return path;
}

}  // namespace

TEST_CASE("under a time budget the trace starts no score that could end too late") {
  if (test::emulated()) return test::skip("an emulator scores nothing within 6 s");
  const test::TempDir dir;
  constexpr double kBudget_s = 6;
  const test::Words run{"ngs-joint", with_many_views(dir, 160), test::fixture_folder() + "/boundary.ply"};
  const test::ProcessResult result = test::run_tool(
      test::joined(run, test::split("--effect all=off --effect joint=on --effect mask=on --steps 1000000 -j 1 "
                                    "--time-budget 6s --trace-every 1 --trace t.jsonl -o l.ply")),
      dir.path());
  INFO(result.err);
  REQUIRE(result.exit_code == 7);
  std::istringstream lines(test::read_bytes(dir.path() + "/t.jsonl"));
  double scored_s = 0, longest_s = 0;
  int scores = 0;
  for (std::string text; std::getline(lines, text);) {
    const Json line = Json::parse(text);
    if (!line.contains("scoring_s")) continue;
    CHECK(line["t"].get<double>() + scored_s + longest_s <=
          kBudget_s);  // a score begins only if the longest one would still fit
    const double now_s = line["scoring_s"];
    longest_s = std::max(longest_s, now_s - scored_s);
    scored_s = now_s;
    ++scores;
  }
  CHECK(scores > 1);
  MESSAGE("longest score: " << longest_s
                            << " s");  // below 0.1 s it would fit into the time reserved for writing anyway
}

TEST_CASE("a time budget that skips only passes that would not have run reports nothing skipped") {
  const test::TempDir dir;
  const std::string scene = with_many_views(dir, 40), model = test::fixture_folder() + "/boundary.ply";
  const auto run = [&](const std::string& name, const std::vector<std::string>& more) {
    const test::Words run{"ngs-joint", scene, model, "-o", name + ".ply", "--report", name + ".json"};
    return test::run_tool(test::joined(run, more), dir.path());
  };
  REQUIRE(run("off", {"--effect", "all=off"}).exit_code == 0);
  const test::ProcessResult result =
      test::succeeded(run("short", {"--effects-from", dir.path() + "/off.json", "--time-budget", "0.01s"}));
  const Json budget = Json::parse(test::read_bytes(dir.path() + "/short.json")).at("result").at("budget");
  CHECK(budget.at("cut") == false);
}

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
    for (const std::string& word : Words{"--steps", "4", "--effect", steps ? "joint=on" : "joint=off", "--effect",
                                         "mask-outliers=on", "--effect", "floaters=on", "--effect", "contours=off"})
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
