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
const char* const kHangul = "\xed\x95\x9c";     // composed
const char* const kHangulParts = "\xe1\x84\x92\xe1\x85\xa1\xe1\x86\xab";

}  // namespace

TEST_CASE("photos and masks are found for names with blanks, other scripts, dots and dashes") {
  for (const std::string& prefix : {std::string("my photo "), std::string(kComposed), std::string(kDecomposed),
                                    std::string("\xe7\x85\xa7\xe7\x89\x87"), std::string("-"), std::string("a.b..c."),
                                    std::string("100%_'$x'"), std::string(240, 'x')}) {
    CAPTURE(prefix);
    const Capture capture({prefixed(prefix), prefixed(prefix), prefixed(prefix)});
    const test::ProcessResult result = capture.import();
    CAPTURE(result.err);
    CHECK(result.exit_code == 0);
    CHECK(capture.views_with("image") == test::kCaptureViews);
    CHECK(capture.views_with("mask") == test::kCaptureViews);
    CHECK(!contains(result.err, "warning"));
  }
}

TEST_CASE("photos and masks are found whose names differ in case or Unicode form only") {
  const struct {
    std::string camera, file;
  } pairs[] = {{kComposed, kDecomposed}, {kDecomposed, kComposed}, {"IMG_", "img_"},
               {"img_", "IMG_"},         {kHangul, kHangulParts},  {"\xc3\x9c_A", "u\xcc\x88_a"}};
  for (const auto& pair : pairs) {
    CAPTURE(pair.file);
    const Capture capture({prefixed(pair.camera), prefixed(pair.file), prefixed(pair.file), ".png", ".PNG", ".Png"});
    const test::ProcessResult result = capture.import();
    CAPTURE(result.err);
    CHECK(result.exit_code == 0);
    CHECK(capture.views_with("image") == test::kCaptureViews);
    CHECK(capture.views_with("mask") == test::kCaptureViews);
  }
}

TEST_CASE("photos with names of no view are named together with the view that lacks one") {
  const Capture capture({prefixed("v"), prefixed("DSC_"), prefixed("v")});
  const test::ProcessResult result = capture.import();
  CHECK(result.exit_code == 0);
  CHECK(
      contains(result.err, "no photo for 6 of 6 views (first: v0.png); ./c/images has other names (first: DSC_0.png)"));
}

TEST_CASE("of two views with one stem the mask belongs to the one whose whole name it has") {
  const Capture capture;
  std::string images = test::read_bytes(capture.path("sparse/0/images.txt"));
  images.replace(images.find("v1.png"), 6, "v0.jpg");
  capture.dir.write("c/sparse/0/images.txt", images);
  fs::rename(capture.path("images/v1.png"), capture.path("images/v0.jpg"));  // the content decides the format
  test::ProcessResult result = capture.import();
  CAPTURE(result.err);
  CHECK(result.exit_code == 0);
  const nlohmann::json scene = capture.scene();
  for (const nlohmann::json& view : scene["views"]) {
    if (view["name"] == "v0.png") CHECK(contains(view.value("mask", ""), "masks/v0.png"));
    if (view["name"] == "v0.jpg") CHECK(view.value("mask", "") == "");
  }
  CHECK(contains(result.err, "no mask for 1 of 6 views (first: v0.jpg)"));
  fs::rename(capture.path("masks/v1.png"), capture.path("masks/v0.jpg.png"));
  result = capture.import();
  CHECK(capture.views_with("mask") == 6);
  CHECK(!contains(result.err, "no mask"));
  fs::rename(capture.path("masks/v0.jpg.png"), capture.path("v1.png"));
  fs::rename(capture.path("masks/v0.png"), capture.path("masks/v0.tif"));
  result = capture.import();
  CHECK(result.exit_code == 4);
  CHECK(contains(result.err, "matches both views v0.jpg and v0.png"));
  CHECK(contains(result.err, "v0.jpg.png"));
}

TEST_CASE("a capture in a folder whose name begins with a dash, with names of all kinds, is cut") {
  const auto name = prefixed("-Gr\xc3\xbc\xc3\x9f 'x' ");
  const Capture capture({name, name, name}, "-cap ture (1)");
  fs::rename(capture.path("point_cloud.ply"), capture.path("-Scan.PLY"));
  const test::ProcessResult result = capture.run({"ngs", "cut", "--quality", "draft", "--", capture.folder()});
  CAPTURE(result.err);
  CHECK(result.exit_code == 0);
  const std::string out = capture.dir.path() + "/-cap ture (1)-cut";
  CHECK(fs::exists(out + "/object.ply"));
  CHECK(fs::exists(out + "/masks/" + name(3) + ".png"));
}

}  // namespace ngs
