// Names of files and folders that people and their systems choose.
#include <doctest/doctest.h>

#include "contract/captures/capture.h"
#include "support/skip.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using test::Capture, test::CaptureNames, test::check_complete, test::contains, test::move;

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

TEST_CASE(
    "masks in folders of cameras and then of objects are read, and one mask in a folder for each photo is moved") {
  const CaptureNames rig{[](int i) { return "cam" + std::to_string(i % 2) + "/" + std::to_string(i); }};
  const Capture cameras({rig.camera, rig.camera, rig.camera});
  for (int i = 0; i < test::kCaptureViews; ++i) {
    const std::string folder = "masks/cam" + std::to_string(i % 2), name = "/" + std::to_string(i) + ".png";
    move(cameras, folder + name, folder + "/cup" + name);
    fs::create_directories(cameras.path(folder + "/plate"));
    fs::copy(cameras.path(folder + "/cup" + name), cameras.path(folder + "/plate" + name));
  }
  check_complete(cameras);
  CHECK(cameras.scene()["views"][0]["mask"] == "c/masks/cam0/{object}/0.png");
  CHECK(cameras.scene()["objects"][1]["name"] == "plate");
  const Capture each;
  for (int i = 0; i < test::kCaptureViews; ++i)
    move(each, "masks/v" + std::to_string(i) + ".png", "masks/v" + std::to_string(i) + "/mask.png");
  const std::string err = each.run({"ngs", "cut", "c", "-o", "out"}).err;
  const std::size_t command = err.find("for d in "), end = err.find("done", command);
  REQUIRE_MESSAGE(end != std::string::npos, err);
  test::succeeded(
      test::run_command({"bash", "-c", "cd " + each.dir.path() + " && " + err.substr(command, end + 4 - command)}));
  check_complete(each);
}

TEST_CASE("the command for arrays makes masks of probabilities and of logits") {
  for (const char* values : {"m / 255 * 0.8 + 0.1", "m / 25.0 - 5"}) {
    CAPTURE(values);
    const Capture capture;
    const auto shell = [&](const std::string& command) {
      return test::run_command({"bash", "-c", "PATH=/usr/bin:$PATH; cd " + capture.dir.path() + " && " + command})
                 .exit_code == 0;
    };
    if (!shell("python3 -c 'import glob, numpy, os; from PIL import Image; [(numpy.save(f[:-4], " +
               std::string(values) +
               "), os.remove(f)) for f in glob.glob(\"c/masks/*.png\") for m in [numpy.array(Image.open(f)) * 1.0]]'"))
      return test::skip("no Python with NumPy and PIL");
    const std::string err = capture.run({"ngs", "cut", "c", "-o", "out"}).err;
    const std::size_t command = err.find("cd "), end = err.find("]\"", command);
    REQUIRE_MESSAGE(end != std::string::npos, err);
    CHECK(shell(err.substr(command, end + 2 - command)));
    check_complete(capture);
  }
}

}  // namespace ngs
