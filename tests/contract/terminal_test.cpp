// The chain on a terminal and under a scheduler.
#include <doctest/doctest.h>
#include <signal.h>

#include <csignal>
#include <cstdlib>
#include <sstream>

#include "support/chain_capture.h"

namespace ngs {
namespace {

/// Runs a command line of the shell on a terminal, whose output is `out`.
test::ProcessResult on_terminal(const std::string& folder, const std::string& command) {
  return test::run_process(test::script_spec(folder, {"script", "-qec", command, "/dev/null"}));
}

}  // namespace

TEST_CASE("ngs-gs.sh on a terminal prints the stage number of each tool") {
  const test::ChainCapture capture;
  const auto ngs_gs = [&](const std::string& further) {
    return on_terminal(capture.dir.path(), NGS_SOURCE_DIR
                                               "/pipelines/ngs-gs.sh 'my scene' out --hold-out every:4:2 "
                                               "--gt 'my scene/masks' --method flash" +
                                               further);
  };
  const test::ProcessResult whole = test::succeeded(ngs_gs(""));
  for (const char* text : {"[1/9] ngs-scene import: done", "[2/9] ngs-variance: done", "[3/9] ngs-joint: done",
                           "[4/9] ngs-extract: done", "[5/9] ngs-render: done", "[9/9] ngs-report: done"}) {
    CAPTURE(text);
    CHECK(whole.out.find(text) != std::string::npos);
  }
  CHECK(whole.out.find("not used") == std::string::npos);  // an option that was not given
  CHECK(whole.out.find("\nrun ") == std::string::npos);    // the scores of a single run, already shown by ngs-eval
  CHECK(ngs_gs(" -q").out == "");
}

TEST_CASE("messages of ngs-gs.sh are wrapped between words at the width of the terminal") {
  const test::TempDir dir;
  test::fs::create_directories(dir.path() + "/empty");
  const test::ProcessResult refused =
      on_terminal(dir.path(), "stty cols 60; " NGS_SOURCE_DIR "/pipelines/ngs-gs.sh empty empty");
  CAPTURE(refused.out);
  CHECK(refused.exit_code == 2);
  for (const char* word : {"/empty:", "result", "another", "outputs"})
    CHECK(refused.out.find(word) != refused.out.npos);
  std::istringstream lines(refused.out);
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) CHECK(line.size() <= 61);  // including the carriage return
  CHECK(count >= 3);
}

TEST_CASE("--explain prints only its list on a terminal, and also the report if stdout is no terminal") {
  const test::TempDir dir;
  test::write_tiny_scene(dir.path());
  test::succeeded(test::run_tool({"ngs-variance", "scene.json", "-o", "boundary.ply"}, dir.path()));
  const test::ProcessResult piped =
      test::succeeded(test::run_tool({"ngs-joint", "scene.json", "boundary.ply", "--explain"}, dir.path()));
  const test::ProcessResult shown =
      test::succeeded(on_terminal(dir.path(), NGS_TOOL_DIR "/ngs-joint scene.json boundary.ply --explain"));
  CHECK(piped.out.starts_with("{"));
  for (const char* name : {"mask-outliers ", "contours ", "full-resolution "}) {
    CAPTURE(name);
    CHECK(piped.err.find(name) != piped.err.npos);
    CHECK(shown.out.find(name) != shown.out.npos);
  }
  CHECK(shown.out.find('{') == shown.out.npos);
}

TEST_CASE("ngs-joint on a terminal ends with readable figures and the next command") {
  const test::TempDir dir;
  test::write_tiny_scene(dir.path());
  test::succeeded(test::run_tool({"ngs-variance", "scene.json", "-o", "boundary.ply"}, dir.path()));
  const test::ProcessResult shown = test::succeeded(
      on_terminal(dir.path(), NGS_TOOL_DIR "/ngs-joint scene.json boundary.ply --quality draft -o labelled.ply"));
  for (const char* text : {"boundary Gaussians ", "changed Gaussians ", "next: ngs-extract labelled.ply"})
    CHECK(shown.out.find(text) != shown.out.npos);
  CHECK(shown.out.find("biou") == shown.out.npos);
}

TEST_CASE("ngs-gs.sh ends the running tool when only the script receives a signal") {
  const test::ChainCapture capture;
  const test::TempDir& dir = capture.dir;
  // Tools of which the first never ends by itself, even if its shell ends.
  test::fs::create_directory(dir.path() + "/bin");
  for (const auto& tool : test::fs::directory_iterator(NGS_TOOL_DIR))
    test::fs::create_symlink(tool.path(), dir.path() + "/bin/" + tool.path().filename().string());
  test::fs::remove(dir.path() + "/bin/ngs-scene");
  dir.write("bin/ngs-scene", "#!/bin/bash\ncase \" $* \" in *' --print-options '*) exec " NGS_TOOL_DIR
                             "/ngs-scene \"$@\" ;; esac\necho $$ > " +
                                 dir.path() + "/at_work\necho at work >&2\nexec sleep 50\n");
  test::fs::permissions(dir.path() + "/bin/ngs-scene", test::fs::perms::owner_all);
  for (const auto& signal : {std::pair{SIGTERM, 143}, {SIGINT, 130}, {SIGHUP, 143}}) {
    const int number = signal.first, code = signal.second;
    CAPTURE(number);
    const test::ProcessResult ended = test::run_process(
        {.argv = {"env", "--default-signal=INT,HUP", NGS_SOURCE_DIR "/pipelines/ngs-gs.sh", "my scene", "out"},
         .environment = {{"NGS_BIN", dir.path() + "/bin"}},
         .folder = dir.path(),
         .signal = number,
         .signal_after = "at work"});
    CAPTURE(ended.err);
    CHECK(ended.exit_code == code);
    const int tool = std::atoi(test::read_bytes(dir.path() + "/at_work").c_str());
    REQUIRE(tool > 0);
    CHECK(kill(tool, 0) != 0);
  }
}

TEST_CASE("a run in a deleted folder names it as the cause") {
  const test::TempDir dir;
  const auto in_deleted = [&](const std::string& command) {
    return test::run_command({"sh", "-c",
                              "mkdir '" + dir.path() + "/gone' && cd '" + dir.path() + "/gone' && rmdir '" +
                                  dir.path() + "/gone' && '" NGS_TOOL_DIR "'/" + command});
  };
  for (const auto& [line, code] : {std::pair{"ngs-synth two-spheres -o out", 8}, std::pair{"ngs info model.ply", 3}}) {
    const std::string command = line;
    CAPTURE(command);
    const test::ProcessResult run = in_deleted(command);
    CHECK(run.exit_code == code);
    CHECK(run.err.find("the current folder was deleted") != std::string::npos);
  }
}

// Scenes passed from tool to tool through pipes with "-".

TEST_CASE("a scene from stdin has paths relative to the working directory, a scene on stdout has absolute paths") {
  const test::TempDir dir;
  test::write_tiny_scene(dir.path());
  const auto label = [&](const std::string& folder, const std::string& scene, const std::string& input) {
    const std::string out = dir.path() + "/b.ply";
    test::fs::remove(out);
    test::succeeded(test::run_tool({"ngs-variance", scene, "-o", out}, folder, {}, input));
    return test::fs::exists(out) ? test::read_bytes(out) : std::string();
  };
  const std::string from_file = label(dir.path(), "scene.json", {});
  CHECK(from_file != "");
  CHECK(label(dir.path(), "-", test::read_bytes(dir.path() + "/scene.json")) == from_file);

  const test::ProcessResult imported = test::succeeded(test::run_tool(
      {"ngs-scene", "import", "sparse", "--ply", "model.ply", "--no-align-views", "-o", "-"}, dir.path()));
  const std::string elsewhere = dir.write("else/where/scene.json", imported.out);
  CHECK(label("/", elsewhere, {}) != "");
  CHECK(label("/", "-", imported.out) == label("/", elsewhere, {}));
}

TEST_CASE("output to stdout leaves no temporary file when the terminal closes, and continues under nohup") {
  const test::TempDir dir;
  test::fs::create_directories(dir.path() + "/tmp");
  const std::string in = dir.write("in", "text");
  test::ProcessSpec spec{.argv = {}, .environment = {{"TMPDIR", dir.path() + "/tmp"}}, .signal_after = "line 5 "};
  const std::vector<std::string> probe{
      NGS_TOOL_DIR "/ngs-probe", in, "-o", "-", "--act", "slow-write", "--count", "20"};
  for (const int signal : {SIGHUP, SIGQUIT}) {
    CAPTURE(signal);
    spec.argv = probe;
    spec.signal = signal;
    CHECK(test::run_process(spec).exit_code == (signal == SIGHUP ? 143 : 130));
    CHECK(test::fs::is_empty(dir.path() + "/tmp"));
  }
  spec.argv = {"env", "--ignore-signal=HUP"};
  spec.signal = SIGHUP;
  spec.argv.insert(spec.argv.end(), probe.begin(), probe.end());
  CHECK(test::run_process(spec).exit_code == 0);
}

TEST_CASE("a failing child program is reported even if the parent ignores SIGCHLD") {
  const test::TempDir dir;
  test::write_tiny_scene(dir.path());
  dir.write("p.json", R"({"ngs_prompts":1,"view":"v0.png","width":48,"height":36,"boxes":[[12,6,36,30]]})");
  const test::Words run =
      test::split("env --ignore-signal=CHLD " NGS_TOOL_DIR "/ngs-mask scene.json --prompts p.json -o m");
  const test::Words segmenter{"--segmenter", "sh -c 'cp masks/v0.png \"$2\"; exit 3' {image} {prompts} {out}"};
  test::refused(test::run_process({.argv = test::joined(run, segmenter), .folder = dir.path()}), 8, "exit code 3");
}

}  // namespace ngs
