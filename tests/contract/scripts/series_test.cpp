// Runs that share a folder: two concurrent runs, and resumed series of runs.
#include <doctest/doctest.h>

#include <set>
#include <thread>

#include "support/chain_capture.h"
#include "support/rule_cases.h"
#include "support/tool_fixture.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::ChainCapture, test::times_of;

std::size_t leftovers_in(const fs::path& folder) {
  std::size_t count = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    count += entry.path().filename().string().starts_with(".ngs-");
  return count;
}

/// The results of two concurrent processes.
std::pair<test::ProcessResult, test::ProcessResult> at_once(const test::ProcessSpec& a, const test::ProcessSpec& b) {
  std::pair<test::ProcessResult, test::ProcessResult> results;
  std::thread other([&] { results.second = test::run_process(b); });
  results.first = test::run_process(a);
  other.join();
  return results;
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
        if (fs::is_regular_file(there[i])) CHECK(test::read_bytes(there[i]) == test::read_bytes(here[i]));
      }
      CHECK(leftovers_in(shared.path()) == 0);
    }
  CHECK(tools.size() >= 10);
}

TEST_CASE("ngs-gs.sh, called twice concurrently on one folder, leaves the files of one call") {
  const ChainCapture capture;
  const auto run = [&](const std::string& out) {
    return capture.spec("ngs-gs.sh", {"my scene", out, "--hold-out", "every:4:2", "--method", "flash", "-q"});
  };
  capture.dir.write("shared/.ngs-1-0.tmp.ply", "what a killed run leaves");
  const auto both = at_once(run("shared"), run("shared"));
  INFO(both.first.err, both.second.err);
  CHECK(both.first.exit_code == 0);
  CHECK(both.second.exit_code == 0);
  CHECK(leftovers_in(capture.path("shared")) == 0);
  test::succeeded(test::run_process(run("alone")));
  for (const std::string name :
       {"scene.json", "boundary.ply", "labelled.ply", "object.ply", "masks/v2.png", "metrics.json"}) {
    CAPTURE(name);
    CHECK(capture.bytes("shared/" + name) == capture.bytes("alone/" + name));
  }
}

TEST_CASE("sweep.sh keeps finished and rejected runs, and restarts killed runs") {
  const ChainCapture capture;
  const std::string plain = "plain 'my scene' --hold-out every:4:2 --method flash\n";
  capture.dir.write(
      "runs", "# two runs\n" + plain + "\nrefused 'my scene' SCENE_FLAGS='--mask-mode \"no such\"' --method flash\n");
  const auto sweep = [&](const test::Words& more) {
    return capture.script("sweep.sh", test::joined({"runs", "out"}, more));
  };
  test::refused(sweep({"--on", "make", "-j", "2"}), 1, "refused failed with exit code 2");
  CHECK(capture.has("out/plain/object.ply"));
  CHECK(capture.has("out/summary.json"));
  const std::string tries = capture.bytes("out/.sweep/tries");
  CHECK(std::count(tries.begin(), tries.end(), '\n') == 2);

  SUBCASE("nothing is started if nothing changed") {
    CHECK(sweep({}).exit_code == 1);
    CHECK(capture.bytes("out/.sweep/tries") == tries);
  }
  SUBCASE("a run without an exit code or with a changed line is started") {
    fs::remove(capture.path("out/.sweep/plain.code"));
    capture.dir.write("runs", plain + "refused 'my scene' --method flash\n");
    CHECK(sweep({"-n"}).out == "plain\nrefused\n");
  }
}

// What pipelines/ngs-gs.sh repeats in a second call, on the tiny scene with the built tools.

namespace {

TEST_CASE("ngs-gs.sh runs only what changed") {
  const ChainCapture capture;
  const std::string out = capture.out;
  std::map<std::string, fs::file_time_type> before, after;
  const auto run = [&](const std::string& method, const test::Environment& flags, const test::Words& more = {}) {
    before = times_of(out);
    test::ProcessResult result = capture.run(test::joined({"--method", method}, more), flags);
    after = times_of(out);
    return result;
  };
  const auto changed = [&](const std::string& name) { return after.at(name) != before.at(name); };
  test::Environment flags;
  fs::create_directories(out);
  test::succeeded(run("flash", flags));

  // Nothing, if nothing changed but the number of threads.
  CHECK(test::succeeded(run("flash", flags, {"-j", "1"})).err ==
        "the output: nothing has changed since the last call\n");
  CHECK(after == before);

  // The steps whose results were removed, and those that read them.
  for (const char* name : {"background.ply", "masks", "metrics.json", "report.html"}) {
    CAPTURE(name);
    fs::remove_all(out + "/" + name);
    CHECK(run("flash", flags).exit_code == 0);
    CHECK(fs::exists(out + "/" + name));
    CHECK_FALSE(changed("labelled.ply"));
  }

  // The scores, if a bound was added; it is not met in a third call either.
  flags.emplace_back("EVAL_FLAGS", "--fail-below iou=1.01");
  CHECK(run("flash", flags).exit_code == 1);
  CHECK_FALSE(changed("labelled.ply"));
  CHECK(changed("metrics.json"));
  CHECK(changed("report.html"));
  CHECK(run("flash", flags).exit_code == 1);
  flags.clear();

  // The boundary and what follows it, if its flags changed.
  flags.emplace_back("VARIANCE_FLAGS", "--tau 0.4");
  CHECK(run("flash", flags).exit_code == 0);
  CHECK_FALSE(changed("scene.json"));
  CHECK(changed("boundary.ply"));
  CHECK(changed("labelled.ply"));

  // The optimisation and what follows it, if the method changed.
  CHECK(run("sa3d", flags).exit_code == 0);
  CHECK_FALSE(changed("boundary.ply"));
  CHECK(changed("labelled.ply"));
  CHECK(changed("report.html"));

  // Everything, if a mask changed.
  fs::copy_file(capture.path("my scene/masks/v0.png"), capture.path("my scene/masks/v1.png"),
                fs::copy_options::overwrite_existing);
  test::succeeded(run("sa3d", flags));
  CHECK(changed("boundary.ply"));
  CHECK(changed("metrics.json"));
}

TEST_CASE("ngs-gs.sh --until stops after the step that writes the file, and fails if nothing was scored") {
  const ChainCapture capture;
  const std::string out = capture.out + "/";
  const auto until = [&](const std::string& file) {
    return capture.ngs_gs({"my scene", "the output", "--method", "flash", "--until", file});
  };
  CHECK(until("labelled.ply").exit_code == 0);
  CHECK(fs::exists(out + "labelled.ply"));
  CHECK_FALSE(fs::exists(out + "field.ply"));
  CHECK_FALSE(fs::exists(out + "masks"));
  CHECK(until("field.ply").exit_code == 0);
  CHECK(fs::exists(out + "field.ply"));
  test::refused(until("metrics.json"), 5, "scores need true masks");
  CHECK(fs::exists(out + "object.ply"));
  CHECK_FALSE(fs::exists(out + ".state/alone"));
  const auto before = times_of(capture.dir.path());
  CHECK(until("objects.zip").exit_code == 2);
  CHECK(times_of(capture.dir.path()) == before);
}

TEST_CASE("NGS_RUN stands before every call of a tool") {
  const ChainCapture capture;
  capture.dir.write("each", "#!/bin/sh\necho $2 >> calls\nexec \"$@\"\n");
  fs::permissions(capture.dir.path() + "/each", fs::perms::owner_all);
  test::succeeded(capture.ngs_gs({"my scene", "the output", "--until", "boundary.ply"}, {{"NGS_RUN", "./each env"}}));
  CHECK(test::read_bytes(capture.dir.path() + "/calls") == "ngs-scene\nngs-variance\n");
}

TEST_CASE("ngs-gs.sh detects a changed photo in a folder that only the transforms file names") {
  const ChainCapture capture;
  const std::string scene = capture.path("my scene/");
  fs::remove_all(scene + "sparse");
  fs::remove(scene + "cameras.json");
  fs::rename(scene + "images", scene + "train photos");
  std::string poses = capture.bytes("my scene/transforms.json");
  for (std::size_t at = 0; (at = poses.find("images/", at)) != poses.npos;) poses.replace(at, 7, "train photos/");
  fs::remove(scene + "transforms.json");
  capture.dir.write("my scene/transforms_train.json", poses);
  const std::string out = capture.out;
  const auto run = [&] { return capture.ngs_gs({"my scene", "the output", "--until", "scene.json"}); };
  test::succeeded(run());
  const auto before = times_of(out);
  CHECK(run().exit_code == 0);
  CHECK(times_of(out) == before);
  fs::copy_file(scene + "train photos/v0.png", scene + "train photos/v1.png", fs::copy_options::overwrite_existing);
  CHECK(run().exit_code == 0);
  CHECK(times_of(out)["scene.json"] != before.at("scene.json"));
}

}  // namespace
}  // namespace ngs
