// Names of files and folders that people and their systems choose.
#include <doctest/doctest.h>

#include "contract/captures/capture.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using test::Capture, test::CaptureNames, test::contains;

std::function<std::string(int)> prefixed(const std::string& prefix) {
  return [prefix](int i) { return prefix + std::to_string(i); };
}

const char* const kComposed = "G\xc3\xbcl";     // ü as one character (NFC)
const char* const kDecomposed = "Gu\xcc\x88l";  // u and a combining mark (NFD), as macOS stores it

}  // namespace

TEST_CASE("photos and masks are found for names with blanks, other scripts, dots and dashes") {
  for (const std::string& prefix : {std::string("my photo "), std::string(kComposed), std::string(kDecomposed),
                                    std::string("\xe7\x85\xa7\xe7\x89\x87"), std::string("-"), std::string("a.b..c."),
                                    std::string("100%_'$x'"), std::string(240, 'x')}) {
    CAPTURE(prefix);
    const Capture capture({prefixed(prefix), prefixed(prefix), prefixed(prefix)});
    const test::ProcessResult result = test::succeeded(capture.import());
    CHECK(capture.views_with("image") == test::kCaptureViews);
    CHECK(capture.views_with("mask") == test::kCaptureViews);
    CHECK(!contains(result.err, "warning"));
  }
}

TEST_CASE("photos with names of no view are named together with the view that lacks one") {
  const Capture capture({prefixed("v"), prefixed("DSC_"), prefixed("v")});
  const test::ProcessResult result = test::succeeded(capture.import());
  CHECK(
      contains(result.err, "no photo for 6 of 6 views (first: v0.png); ./c/images has other names (first: DSC_0.png)"));
}

TEST_CASE("a capture in a folder whose name begins with a dash, with names of all kinds, is cut") {
  const auto name = prefixed("-Gr\xc3\xbc\xc3\x9f 'x' ");
  const Capture capture({name, name, name}, "-cap ture (1)");
  fs::rename(capture.path("point_cloud.ply"), capture.path("-Scan.PLY"));
  test::succeeded(capture.run({"ngs", "cut", "--quality", "draft", "--", capture.folder()}));
  const std::string out = capture.dir.path() + "/-cap ture (1)-cut";
  CHECK(fs::exists(out + "/object.ply"));
  CHECK(fs::exists(out + "/masks/" + name(3) + ".png"));
}

}  // namespace ngs
