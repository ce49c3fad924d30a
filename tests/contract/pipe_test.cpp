// A scene that goes from tool to tool through a pipe, as "-" promises.
#include <doctest/doctest.h>

#include <filesystem>

#include "support/process.h"
#include "support/temp_dir.h"
#include "support/tiny_scene.h"

namespace ngs {
namespace {

test::ProcessResult run_in(const std::string& folder, std::vector<std::string> argv, const std::string& input = {}) {
  test::ProcessSpec spec;
  argv[0] = NGS_TOOL_DIR "/" + argv[0];
  spec.argv = std::move(argv), spec.folder = folder, spec.input = input;
  spec.environment = {{"NGS_THREADS", "2"}};
  return test::run_process(spec);
}

}  // namespace

TEST_CASE("a scene from stdin names its files from the working directory, one to stdout names them from the root") {
  const test::TempDir dir;
  test::write_tiny_scene(dir.path());
  const auto label = [&](const std::string& folder, const std::string& scene, const std::string& input) {
    const std::string out = dir.path() + "/b.ply";
    std::filesystem::remove(out);
    const test::ProcessResult result = run_in(folder, {"ngs-variance", scene, "-o", out}, input);
    INFO(result.err);
    CHECK(result.exit_code == 0);
    return std::filesystem::exists(out) ? test::read_bytes(out) : std::string();
  };
  const std::string from_file = label(dir.path(), "scene.json", {});
  CHECK(from_file != "");
  CHECK(label(dir.path(), "-", test::read_bytes(dir.path() + "/scene.json")) == from_file);

  const test::ProcessResult imported =
      run_in(dir.path(), {"ngs-scene", "import", "sparse", "--ply", "model.ply", "--no-align-views", "-o", "-"});
  INFO(imported.err);
  REQUIRE(imported.exit_code == 0);
  const std::string elsewhere = dir.write("else/where/scene.json", imported.out);
  CHECK(label("/", elsewhere, {}) != "");
  CHECK(label("/", "-", imported.out) == label("/", elsewhere, {}));
}

}  // namespace ngs
