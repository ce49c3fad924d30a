// The chain as a person at a terminal sees it.
#include <doctest/doctest.h>

#include <filesystem>

#include "support/process.h"
#include "support/temp_dir.h"
#include "support/tiny_scene.h"

namespace ngs {

TEST_CASE("ngs-gs.sh on a terminal says which of all stages each tool is, and at the end what was made") {
  const test::TempDir dir;
  std::filesystem::create_directories(dir.path() + "/my scene");
  test::write_tiny_scene(dir.path() + "/my scene");
  std::filesystem::remove(dir.path() + "/my scene/scene.json");
  const std::string options = " 'my scene' out --hold-out every:4:2 --gt 'my scene/masks' --method flash";
  const auto on_terminal = [&](const std::string& further) {
    return test::run_process(
        {.argv = {"script", "-qec", NGS_SOURCE_DIR "/pipelines/ngs-gs.sh" + options + further, "/dev/null"},
         .environment = {{"NGS_BIN", NGS_TOOL_DIR}, {"NGS_THREADS", "2"}},
         .folder = dir.path(),
         .input = {},
         .signal_after = {}});
  };
  const auto has = [](const test::ProcessResult& result, const std::string& text) {
    CAPTURE(text);
    CHECK(result.out.find(text) != std::string::npos);
  };
  const test::ProcessResult part = on_terminal(" --until masks");
  CAPTURE(part.out);
  CHECK(part.exit_code == 0);
  for (const char* text : {"[1/4] ngs-scene import: done", "[2/4] ngs-variance: done", "[3/4] ngs-joint: done",
                           "[4/4] ngs-render: done", "  masks/: 1 mask(s) of the result"})
    has(part, text);
  const test::ProcessResult whole = on_terminal("");
  CAPTURE(whole.out);
  CHECK(whole.out.find("ngs-joint: done") == std::string::npos);  // nothing of it changed
  for (const char* text :
       {"[4/7] ngs-extract: done", "[7/7] ngs-report: done", "ngs-gs.sh: done in ", "  object.ply, background.ply: ",
        "  scores: IoU 1.0000, boundary IoU 1.0000, in its 0.5 % band 1.0000", "/out/report.html in a browser"})
    has(whole, text);
  CHECK(on_terminal(" -q").out == "");
}

}  // namespace ngs
