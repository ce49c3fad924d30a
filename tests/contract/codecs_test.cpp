// The image codecs are a plug-in, because loading their libraries takes longer than the work of a small tool.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

#include "ngs/core/error.h"
#include "support/process.h"
#include "support/skip.h"
#include "support/temp_dir.h"
#include "support/tool_fixture.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;

}  // namespace

TEST_CASE("a tool without the codecs plug-in names the missing file and its folder, and needs it for images only") {
  if (test::emulated()) return test::skip("the tool may be a script that starts the emulator");
  const test::TempDir dir;
  const fs::path alone = fs::path(dir.path()) / "ngs-variance";
  fs::copy_file(fs::path(NGS_TOOL_DIR) / "ngs-variance", alone);
  CHECK(test::run_command({alone, "--version"}).exit_code == 0);
  const std::string out = dir.path() + "/boundary.ply";
  const test::ProcessResult result = test::run_command({alone, test::fixture_folder() + "/scene.json", "-o", out});
  CHECK(result.exit_code == int(ErrorCode::kEnvironment));
  CHECK(result.err.find("libngs_codecs.so") != std::string::npos);
  CHECK(result.err.find("hint: keep it next to the executables") != std::string::npos);
  CHECK(!fs::exists(out));
}

TEST_CASE("no executable loads the libraries of the image codecs before it needs one") {
  for (const fs::directory_entry& entry : fs::directory_iterator(NGS_TOOL_DIR)) {
    const std::string name = entry.path().filename();
    if (name.rfind("ngs-", 0) != 0) continue;
    CAPTURE(name);
    std::ifstream file(entry.path(), std::ios::binary);
    const std::string bytes(std::istreambuf_iterator<char>(file), {});
    CHECK(bytes.find("libopencv_imgcodecs") == std::string::npos);
  }
}

}  // namespace ngs
