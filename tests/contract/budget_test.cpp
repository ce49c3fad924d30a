// Effect of --time-budget on the trace and on the exit code.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

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
  scene["views"] = views, scene["model"] = test::fixture_folder() + "/model.ply";
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
    longest_s = std::max(longest_s, now_s - scored_s), scored_s = now_s, ++scores;
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

}  // namespace ngs
