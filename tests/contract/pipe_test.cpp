// Scenes passed from tool to tool through pipes with "-".
#include <doctest/doctest.h>

#include <csignal>
#include <filesystem>

#include "support/process.h"
#include "support/temp_dir.h"
#include "support/tiny_scene.h"

namespace ngs {
namespace {

test::ProcessResult run_in(const std::string& folder, const test::Words& argv, const std::string& input = {}) {
  return test::run_tool(argv, folder, {}, input);
}

}  // namespace

TEST_CASE("a scene from stdin has paths relative to the working directory, a scene on stdout has absolute paths") {
  const test::TempDir dir;
  test::write_tiny_scene(dir.path());
  const auto label = [&](const std::string& folder, const std::string& scene, const std::string& input) {
    const std::string out = dir.path() + "/b.ply";
    std::filesystem::remove(out);
    test::succeeded(run_in(folder, {"ngs-variance", scene, "-o", out}, input));
    return std::filesystem::exists(out) ? test::read_bytes(out) : std::string();
  };
  const std::string from_file = label(dir.path(), "scene.json", {});
  CHECK(from_file != "");
  CHECK(label(dir.path(), "-", test::read_bytes(dir.path() + "/scene.json")) == from_file);

  const test::ProcessResult imported = test::succeeded(
      run_in(dir.path(), {"ngs-scene", "import", "sparse", "--ply", "model.ply", "--no-align-views", "-o", "-"}));
  const std::string elsewhere = dir.write("else/where/scene.json", imported.out);
  CHECK(label("/", elsewhere, {}) != "");
  CHECK(label("/", "-", imported.out) == label("/", elsewhere, {}));
}

TEST_CASE("output to stdout leaves no temporary file when the terminal closes, and continues under nohup") {
  const test::TempDir dir;
  std::filesystem::create_directories(dir.path() + "/tmp");
  const std::string in = dir.write("in", "text");
  test::ProcessSpec spec;
  spec.environment = {{"TMPDIR", dir.path() + "/tmp"}};
  spec.signal_after = "line 5 ";
  const std::vector<std::string> probe{
      NGS_TOOL_DIR "/ngs-probe", in, "-o", "-", "--act", "slow-write", "--count", "20"};
  for (const int signal : {SIGHUP, SIGQUIT}) {
    CAPTURE(signal);
    spec.argv = probe, spec.signal = signal;
    CHECK(test::run_process(spec).exit_code == (signal == SIGHUP ? 143 : 130));
    CHECK(std::filesystem::is_empty(dir.path() + "/tmp"));
  }
  spec.argv = {"env", "--ignore-signal=HUP"}, spec.signal = SIGHUP;
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
  const test::ProcessResult result = test::run_process({.argv = test::joined(run, segmenter), .folder = dir.path()});
  INFO(result.err);
  CHECK(result.exit_code == 8);
  CHECK(result.err.find("exit code 3") != std::string::npos);
}

}  // namespace ngs
