// Runs that share a folder: two concurrent runs, and resumed series of runs.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <thread>

#include "support/process.h"
#include "support/rule_cases.h"
#include "support/temp_dir.h"
#include "support/tiny_scene.h"
#include "support/tool_fixture.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string bytes_of(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

std::size_t leftovers_in(const fs::path& folder) {
  std::size_t count = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    count += entry.path().filename().string().starts_with(".ngs-");
  return count;
}

test::ProcessSpec script(const std::string& name, const std::string& folder, const test::Words& arguments) {
  return {.argv = test::joined({NGS_SOURCE_DIR "/pipelines/" + name}, arguments),
          .environment = {{"NGS_BIN", NGS_TOOL_DIR}, {"NGS_THREADS", "1"}, {"SAMPLE_FLAGS", "--rows 8 --cols 8"}},
          .folder = folder};
}

/// The results of two concurrent processes.
std::pair<test::ProcessResult, test::ProcessResult> at_once(const test::ProcessSpec& a, const test::ProcessSpec& b) {
  std::pair<test::ProcessResult, test::ProcessResult> results;
  std::thread other([&] { results.second = test::run_process(b); });
  results.first = test::run_process(a);
  other.join();
  return results;
}

std::string tiny_capture(const test::TempDir& dir) {
  std::string scene = dir.path() + "/capture";
  fs::create_directories(scene);
  test::write_tiny_scene(scene);
  fs::remove(scene + "/scene.json");
  return scene;
}

}  // namespace

TEST_CASE("every tool, run twice concurrently on one output, leaves the bytes of one run and nothing else") {
  std::set<std::string> tools;
  for (const auto& [file, cases] : test::contract_cases())
    for (const json& each : cases) {
      if (!each.contains("same_bytes") || each.contains("setup") || each.contains("before")) continue;
      if (each.at("run").at(0) == "ngs") continue;  // locks its folder: the second run ends with exit code 8
      if (!tools.insert(each.at("run").at(0)).second) continue;
      CAPTURE(each.at("name").get<std::string>());
      const test::TempDir shared, alone;
      const auto spec = [&](const test::TempDir& tmp) {
        json run = test::resolved(each.at("run"), tmp.path(), test::fixture_folder());
        run.push_back("-w");
        test::ProcessSpec command = test::command(run);
        command.folder = tmp.path();
        return command;
      };
      const auto both = at_once(spec(shared), spec(shared));
      INFO(both.first.err, both.second.err);
      const auto& [first, second] = both;
      CHECK(first.exit_code == each.value("exit", 0));
      CHECK(second.exit_code == first.exit_code);
      test::run_process(spec(alone));
      const std::vector<std::string> there = test::words(test::resolved(each.at("same_bytes"), shared.path(), "")),
                                     here = test::words(test::resolved(each.at("same_bytes"), alone.path(), ""));
      for (std::size_t i = 0; i < there.size(); ++i) {
        CAPTURE(there[i]);
        REQUIRE(fs::exists(there[i]));
        if (fs::is_regular_file(there[i])) CHECK(bytes_of(there[i]) == bytes_of(here[i]));
      }
      CHECK(leftovers_in(shared.path()) == 0);
    }
  CHECK(tools.size() >= 10);
}

TEST_CASE("ngs-gs.sh, called twice concurrently on one folder, leaves the files of one call") {
  const test::TempDir dir;
  tiny_capture(dir);
  const auto run = [&](const std::string& out) {
    return script("ngs-gs.sh", dir.path(), {"capture", out, "--hold-out", "every:4:2", "--method", "flash", "-q"});
  };
  fs::create_directories(dir.path() + "/shared");
  std::ofstream(dir.path() + "/shared/.ngs-1-0.tmp.ply") << "what a killed run leaves";
  const auto both = at_once(run("shared"), run("shared"));
  INFO(both.first.err, both.second.err);
  const auto& [first, second] = both;
  CHECK(first.exit_code == 0);
  CHECK(second.exit_code == 0);
  CHECK(leftovers_in(dir.path() + "/shared") == 0);
  REQUIRE(test::run_process(run("alone")).exit_code == 0);
  for (const char* name :
       {"scene.json", "boundary.ply", "labelled.ply", "object.ply", "masks/v2.png", "metrics.json"}) {
    CAPTURE(name);
    CHECK(bytes_of(dir.path() + "/shared/" + name) == bytes_of(dir.path() + "/alone/" + name));
  }
}

TEST_CASE("sweep.sh keeps finished and rejected runs, and restarts killed runs") {
  const test::TempDir dir;
  tiny_capture(dir);
  const std::string runs = dir.path() + "/runs", out = dir.path() + "/out";
  std::ofstream(runs) << "# two runs\n"
                         "plain capture --hold-out every:4:2 --method flash\n\n"
                         "refused capture SCENE_FLAGS='--mask-mode \"no such\"' --method flash\n";
  const test::ProcessResult first =
      test::run_process(script("sweep.sh", dir.path(), {runs, "out", "--on", "make", "-j", "2"}));
  INFO(first.err);
  CHECK(first.exit_code == 1);
  CHECK(first.err.find("refused failed with exit code 2") != std::string::npos);
  CHECK(fs::exists(out + "/plain/object.ply"));
  CHECK(fs::exists(out + "/summary.json"));
  const std::string tries = bytes_of(out + "/.sweep/tries");
  CHECK(std::count(tries.begin(), tries.end(), '\n') == 2);

  SUBCASE("nothing is started if nothing changed") {
    CHECK(test::run_process(script("sweep.sh", dir.path(), {runs, "out"})).exit_code == 1);
    CHECK(bytes_of(out + "/.sweep/tries") == tries);
  }
  SUBCASE("a run without an exit code or with a changed line is started") {
    fs::remove(out + "/.sweep/plain.code");
    std::ofstream(runs) << "plain capture --hold-out every:4:2 --method flash\nrefused capture --method flash\n";
    const test::ProcessResult plan = test::run_process(script("sweep.sh", dir.path(), {runs, "out", "-n"}));
    CHECK(plan.out == "plain\nrefused\n");
  }
}

}  // namespace ngs
