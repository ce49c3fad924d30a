// Requirements for every script of pipelines/: --help, the right output folder, the given tools, and never scores,
// masks or parts of an earlier call with other settings.
#include <doctest/doctest.h>

#include <set>

#include "support/chain_capture.h"
#include "support/skip.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/// The capture in a folder whose name has no blank.
struct Folder : test::ChainCapture {
  Folder() : ChainCapture("capture") {}
  /// Writes OUT/scene.json and OUT/boundary.ply.
  test::ProcessResult evidence(const std::string& to, const std::string& hold_out) const {
    return ngs_gs({"capture", to, "--hold-out", hold_out, "--until", "boundary.ply"});
  }
  /// The fastest run of ngs-gs.sh, v2 held out.
  test::ProcessResult quick(const std::string& to, const Words& more = {}, const test::Environment& set = {}) const {
    return ngs_gs(test::joined({"capture", to, "--hold-out", "every:4:2", "--method", "flash", "-q"}, more), set);
  }
  test::ProcessResult run(const Words& argv, const test::Environment& more = {}) const {
    return test::run_process(test::script_spec(dir.path(), argv, more));
  }
};

TEST_CASE("every user script prints its usage with --help and does nothing else") {
  const test::TempDir dir;
  const std::set<std::string> parts{"work-point.sh", "common.sh", "slurm-cluster.sh", "device.sh"};
  std::vector<std::string> scripts;
  for (const char* folder : {"pipelines/", "tests/bench/", "tests/ci/"})
    for (const fs::directory_entry& file : fs::directory_iterator(std::string(NGS_SOURCE_DIR "/") + folder))
      if (const std::string name = file.path().filename().string(); name.ends_with(".sh") && !parts.contains(name))
        scripts.push_back(folder + name);
  for (const std::string& script : scripts) {
    CAPTURE(script);
    // A PATH without programs that install or build: an attempt would fail.
    const test::ProcessSpec spec{.argv = {std::string(NGS_SOURCE_DIR "/") + script, "--help"},
                                 .environment = {{"PATH", dir.path() + "/bin"}},
                                 .folder = dir.path()};
    fs::create_directories(dir.path() + "/bin");
    for (const char* needed : {"bash", "dirname", "sed", "env"})
      if (!fs::exists(dir.path() + "/bin/" + needed))
        fs::create_symlink(std::string("/usr/bin/") + needed, dir.path() + "/bin/" + needed);
    const test::ProcessResult result = test::succeeded(test::run_process(spec));
    CHECK(result.err == "");
    CHECK(result.out.find(script) != std::string::npos);
  }
  CHECK_FALSE(scripts.empty());
}

TEST_CASE("an exported CDPATH does not redirect output to another folder") {
  const Folder f;
  fs::create_directories(f.path("elsewhere/out"));
  test::succeeded(f.quick("out", {}, {{"CDPATH", f.path("elsewhere")}}));
  CHECK(f.has("out/object.ply"));
  CHECK(fs::is_empty(f.path("elsewhere/out")));
  const test::ProcessSpec relative{
      .argv = {"pipelines/ngs-gs.sh", "--help"}, .environment = {{"CDPATH", "."}}, .folder = NGS_SOURCE_DIR};
  CHECK(test::run_process(relative).exit_code == 0);
  CHECK(test::run_process(relative).err == "");
}

TEST_CASE("NGS_BIN may be relative; missing tools are an environment error") {
  const Folder f;
  fs::create_directory_symlink(NGS_TOOL_DIR, f.path("tools"));
  test::succeeded(f.quick("out", {}, {{"NGS_BIN", "tools"}}));
  CHECK(f.has("out/scene.json"));
  test::refused(f.quick("none", {}, {{"NGS_BIN", "capture"}}), 8, "NGS_BIN=capture: does not contain the tools");
  CHECK_FALSE(f.has("none/scene.json"));
}

TEST_CASE("the printed commands of a dry run give the same files as a run") {
  const Folder f;
  const test::ProcessResult plan = test::succeeded(f.quick("by hand", {"-n"}));
  f.dir.write("plan.sh", plan.out);
  const test::Environment tools{{"NGS_THREADS", "1"}, {"PATH", std::string(NGS_TOOL_DIR ":") + std::getenv("PATH")}};
  test::succeeded(
      test::run_process({.argv = {"bash", "-e", f.path("plan.sh")}, .environment = tools, .folder = f.dir.path()}));
  REQUIRE(f.quick("out").exit_code == 0);
  for (const char* name : {"scene.json", "labelled.ply", "object.ply", "masks/v2.png", "metrics.json"}) {
    CAPTURE(name);
    CHECK(f.bytes(std::string("by hand/") + name) == f.bytes(std::string("out/") + name));
  }
  // A later run recognises the masks as its own.
  CHECK(f.quick("by hand").exit_code == 0);
}

TEST_CASE("sweep.sh rejects a series that it could not finish, before any run starts") {
  const Folder f;
  const auto refused = [&](const std::string& runs, const std::string& because) {
    f.dir.write("runs", runs);
    test::refused(f.script("sweep.sh", {"runs", "out"}), 2, because);
    CHECK_FALSE(f.has("out/a"));
  };
  refused("a capture --method flash\na capture --method sa3d\n", "runs:2: duplicate run name 'a'");
  refused("a capture VARIANCES_FLAGS='--tau 0.1'\n", "VARIANCES_FLAGS is not used by any run");
  refused("a capture --method flash\nb/c capture\n", "runs:2: 'b/c' is not a valid run name");
  const test::ProcessResult absent = f.script("sweep.sh", {"runs", "out", "--on", "slurm"}, {{"PATH", "/bin"}});
  if (!fs::exists("/bin/sbatch")) CHECK(absent.exit_code == 8);
}

TEST_CASE("sweep.sh passes JOINT_FLAGS to ngs-joint, and runs in a folder of any name with make") {
  const Folder f;
  f.dir.write("runs", "a '" + f.path("capture") + "' JOINT_FLAGS='--method sa3d' --hold-out every:4:2\n");
  test::succeeded(f.script("sweep.sh", {"runs", "it's $HOME, \xc3\xbc", "--on", "make"}, {{"LC_ALL", "C"}}));
  CHECK(f.json("it's $HOME, \xc3\xbc/a/reports/ngs-joint.json")["options"]["method"] == "sa3d");
}

TEST_CASE("sweep.sh reports why there is no comparison, and fails") {
  const Folder f;
  f.dir.write("runs", "a '" + f.path("capture") + "' --hold-out every:4:2 --method flash\n");
  fs::create_directories(f.path("out/report.html"));
  const test::ProcessResult result =
      test::refused(f.script("sweep.sh", {"runs", "out"}), 2, "report.html: is a folder, expected a file");
  CHECK(result.err.find("1 of 1 runs are finished") != std::string::npos);
}

TEST_CASE("ngs-gs.sh resolves option files relative to the working directory") {
  const Folder f;
  const auto steps = [&](const char* text, Words more, const std::string& flags = {}) {
    f.dir.write("joint.json", text);
    test::succeeded(f.quick("out", more, {{"JOINT_FLAGS", flags}}));
    return f.json("out/reports/ngs-joint.json")["options"]["steps"].get<int>();
  };
  CHECK(steps("{\"steps\": 3}", {"--options", "joint.json"}) == 3);
  CHECK(steps("{\"steps\": 14}", {"--options", "joint.json"}) == 14);
  CHECK(steps("{\"steps\": 155}", {"--options=joint.json"}) == 155);
  CHECK(steps("{\"steps\": 1666}", {}, "--options joint.json") == 1666);
}

TEST_CASE("ngs-gs.sh rejects an option that a later tool would reject before the first tool runs") {
  const Folder f;
  const auto refused = [&](const Words& more, const test::Environment& environment, const std::string& because) {
    test::refused(f.quick("out", more, environment), 2, because);
    CHECK_FALSE(f.has("out/scene.json"));
  };
  refused({"--stepps", "5"}, {}, "ngs-joint: error: unknown flag '--stepps'");
  refused({"--quality", "best"}, {}, "quality");
  refused({"-n", "--steps", "many"}, {}, "steps");
  refused({}, {{"EVAL_FLAGS", "--threshold 300"}}, "ngs-eval: error: threshold = 300");
  refused({"--log-format", "xml"}, {}, "log_format");
}

TEST_CASE("the mean over scenes counts every existing score once") {
  const Folder f;
  const auto summary = [&](const char* name, const char* biou) {
    return f.dir.write(
        name, std::string("{\n  \"mean_over_runs\": {\n    \"iou\": 0.5,\n    \"biou\": ") + biou + "\n  }\n}\n");
  };
  const Words files{summary("a.json", "null"), summary("b.json", "null"), summary("c.json", "0.75")};
  const test::ProcessResult result =
      f.run({"bash", "-c", ". " NGS_SOURCE_DIR "/pipelines/common.sh; mean_of_summaries \"$@\"", "bash", files[0],
             files[1], files[2]});
  CHECK(result.err ==
        "mean over 3 scenes: iou              0.5000\n"
        "mean over 1 scenes: biou             0.7500\n");
}

TEST_CASE("robustness.mk makes new masks if the seed changed, and compares no scores of an earlier call") {
  const Folder f;
  const auto series = [&](Words more) {
    more.insert(more.begin(),
                {"SCENE=capture", "TRUTH=capture/masks", "OUT=out", "DAMAGES=wrong", "METHODS=flash sa3d"});
    return f.make("robustness.mk", more);
  };
  const auto masks = [&] {
    std::string all;
    for (int v = 0; v < 8; ++v) all += f.bytes("out/masks-wrong/v" + std::to_string(v) + ".png");
    return all;
  };
  const std::string options = "ARGS=--hold-out every:4:2";
  const test::ProcessResult first = test::succeeded(series({options}));
  CHECK(first.err.find("unlink") == std::string::npos);
  CHECK(f.json("out/summary.json")["result"]["means"].size() == 2);
  const std::string before = masks();
  const auto made = fs::last_write_time(f.path("out/masks-wrong"));
  CHECK(series({options}).exit_code == 0);
  CHECK(fs::last_write_time(f.path("out/masks-wrong")) == made);
  REQUIRE(series({options, "SEED=3"}).exit_code == 0);
  CHECK(masks() != before);
  const test::ProcessResult failed = series({options + " --tau-of-nothing 3"});
  CHECK(failed.exit_code != 0);
  CHECK(failed.err.find("variant wrong@flash failed, left out") != std::string::npos);
  CHECK(failed.err.find("no scene finished") != std::string::npos);
}

TEST_CASE("sharded.mk merges no shards of other options, and writes the bytes of one run") {
  const Folder f;
  REQUIRE(f.evidence("one", "every:4:2").exit_code == 0);
  const auto sharded = [&](Words more) {
    more.insert(more.begin(), {"SCENE_JSON=one/scene.json", "OUT=s.ply", "SHARDS=2"});
    test::succeeded(f.make("sharded.mk", more));
    return f.bytes("s.ply");
  };
  const std::string one = f.bytes("one/boundary.ply");
  CHECK(sharded({}) == one);
  CHECK(sharded({"VARIANCE_FLAGS=--tau 0.2"}) != one);
  CHECK(sharded({}) == one);
  // A series that was stopped half way and is resumed with other options.
  fs::remove(f.path("s.ply.parts/1-of-2.evidence"));
  const std::string other = sharded({"RASTER_FLAGS=--antialias on"});
  REQUIRE(
      f.run({NGS_TOOL_DIR "/ngs-variance", "one/scene.json", "--antialias", "on", "-q", "-o", "on.ply"}).exit_code ==
      0);
  CHECK(other == f.bytes("on.ply"));
  CHECK(other != one);
}

TEST_CASE("sharded.mk merges no parts of another scene, even if that scene is older") {
  const Folder f;
  REQUIRE(f.evidence("held", "every:2:0").exit_code == 0);
  REQUIRE(f.evidence("all", "every:4:2").exit_code == 0);
  const auto made = [&](const std::string& scene) {
    test::succeeded(f.make("sharded.mk", {"SCENE_JSON=" + scene + "/scene.json", "OUT=s.ply", "SHARDS=2"}));
    return f.bytes("s.ply");
  };
  CHECK(made("all") == f.bytes("all/boundary.ply"));
  CHECK(made("held") == f.bytes("held/boundary.ply"));
}

TEST_CASE(
    "another CMake project that adds ngs as a folder compiles against it, in its arithmetic and without its tests") {
  const Folder f;
  f.dir.write("CMakeLists.txt",
              "cmake_minimum_required(VERSION 3.25)\nproject(user CXX)\n"
              "add_subdirectory(" NGS_SOURCE_DIR
              " ngs)\n"
              "if(TARGET test_unit)\n  message(FATAL_ERROR \"the tests came along\")\nendif()\n"
              "add_library(user OBJECT user.cpp)\ntarget_link_libraries(user PRIVATE ngs::ngs)\n");
  // Compiler flags that the library's inline functions require: the same instruction set, no contraction.
  f.dir.write(
      "user.cpp",
      "#include \"ngs/core/version.h\"\n#include \"ngs/io/ply/gaussian_ply.h\"\n#include \"ngs/ops/splat/splat.h\"\n"
      "#if defined(__x86_64__) && !defined(__AVX2__)\n#error not compiled for x86-64-v3\n#endif\n"
      "const char* version() { return ngs::kVersion; }\n"
      "long rows(const char* path) { return ngs::io::read_gaussian_ply(path).cloud.size(); }\n");
  const test::ProcessResult configured = f.run({"cmake", "-S", ".", "-B", "build", "-G", "Ninja"});
  if (configured.exit_code == 127) return test::skip("no cmake");
  INFO(configured.out << configured.err);
  REQUIRE(configured.exit_code == 0);
  const test::ProcessResult compiled =
      test::succeeded(f.run({"cmake", "--build", "build", "--target", "user", "--verbose"}));
  CHECK(compiled.out.find("-ffp-contract=off") != std::string::npos);
  CHECK_FALSE(f.has("build/bin/ngs-joint"));  // only the requested target
}

TEST_CASE("a build for AVX2 reports a processor without AVX2 before it does anything else") {
#ifndef __x86_64__
  return test::skip("this build is for another processor");
#endif
  const Folder f;
  const test::ProcessResult old = f.run({"qemu-x86_64", "-cpu", "Nehalem", NGS_TOOL_DIR "/ngs-joint", "--version"});
  if (old.exit_code == 127) return test::skip("no qemu-x86_64 (package qemu-user)");
  if (old.exit_code == 0) return test::skip("this build is for any processor");
  CHECK(old.exit_code == 8);
  CHECK(old.err.find("this processor has no AVX2") != std::string::npos);
  CHECK(old.err.find("NGS_PRESET=portable") != std::string::npos);
}

}  // namespace
}  // namespace ngs
