#include <doctest/doctest.h>

#include "contract/captures/capture.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/ply/gaussian_ply.h"
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
  for (const std::string& prefix : {std::string("v"), std::string("my photo "), std::string(kComposed),
                                    std::string(kDecomposed), std::string("\xe7\x85\xa7\xe7\x89\x87"), std::string("-"),
                                    std::string("a.b..c."), std::string("100%_'$x'"), std::string(240, 'x')}) {
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

namespace {

using test::Capture, test::contains;

void copy(const Capture& capture, const std::string& from, const std::string& to) {
  fs::create_directories(fs::path(capture.path(to)).parent_path());
  fs::copy(capture.path(from), capture.path(to), fs::copy_options::recursive);
}

/// Whether import succeeds and prints all parts.
void check_note(const Capture& capture, const std::vector<std::string>& parts) {
  const test::ProcessResult result = test::succeeded(capture.import());
  for (const std::string& part : parts) CHECK_MESSAGE(contains(result.err, part), part);
}

}  // namespace

TEST_CASE("photos without cameras, and cameras without photos or masks, are counted and the first is named") {
  const Capture capture;
  copy(capture, "images/v0.png", "images/extra.png");
  copy(capture, "masks/v0.png", "masks/extra.png");
  fs::remove(capture.path("images/v3.png"));
  for (const char* name : {"v1", "v3", "v5"}) fs::remove(capture.path(std::string("masks/") + name + ".png"));
  check_note(capture,
             {"images: 1 images without a camera (first: extra.png)", "no photo for 1 of 6 views (first: v3.png)",
              "masks: 1 images match no view", "extra.png", "no mask for 3 of 6 views (first: v1.png)"});
}

TEST_CASE("other folders of photos, masks and cameras are named") {
  const Capture capture;
  copy(capture, "images", "images_2");
  copy(capture, "images", "input");
  copy(capture, "masks", "masks_sam");
  copy(capture, "sparse/0", "sparse/1");
  capture.dir.write("c/transforms.json", "{\"frames\": []}");
  check_note(capture, {"images: used for photos, not images_2, input (choose another with --images DIR)",
                       "masks: used for masks, not masks_sam", "also holds sparse/1", "also holds transforms.json"});
}

// The whole chain on a capture in other units of length: a coin in metres, a town in millimetres.

namespace {

using test::Capture;

constexpr double kExact[] = {0x1p-10, 0x1p10};  // positions keep their digits
constexpr double kRounded[] = {1e-3, 1e3};
constexpr int kMaxPixels = 2;  // of all masks, whose rendered value is next to the threshold

/// Number of differing bytes of all PNGs with these names in two folders.
int differing_pixels(const std::string& a, const std::string& b) {
  int count = 0, files = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(a)) {
    if (entry.path().extension() != ".png") continue;
    const io::RawMask one = io::read_mask_raw(entry.path().string(), io::Palette::kColours),
                      other = io::read_mask_raw(b + "/" + entry.path().filename().string(), io::Palette::kColours);
    REQUIRE(one.data.size() == other.data.size());
    for (std::size_t i = 0; i < one.data.size(); ++i) count += one.data[i] != other.data[i];
    ++files;
  }
  CHECK(files > 0);
  return count;
}

/// Rows of the object and labels of the model, as `ngs cut` writes them.
std::vector<float> labels_in(const std::string& out) {
  return io::read_gaussian_ply(out + "/labelled.ply").labels.label.values();
}

}  // namespace

TEST_CASE("a capture of any unit is imported without a flag, and gets the labels and masks of the original") {
  const auto cut = [](const Capture& capture, double factor) {
    CAPTURE(factor);
    if (factor != 1) capture.scale(factor);
    test::succeeded(capture.import());
    CHECK((capture.scene().value("world_unit", 1.0) < 1) == (factor < 0.1));
    CHECK(capture.scene()["compat"] == "inria");
    for (const std::vector<std::string>& argv :
         {std::vector<std::string>{"ngs-variance", "s.json", "-o", "b.ply"},
          {"ngs-joint", "s.json", "b.ply", "--quality", "draft", "-o", "labelled.ply"},
          {"ngs-render", "s.json", "labelled.ply", "--views", "all", "--layers", "mask", "-o", "m"}})
      test::succeeded(capture.run(argv));
    return labels_in(capture.dir.path());
  };
  const Capture plain;
  const std::vector<float> expected = cut(plain, 1);
  for (const bool exact : {true, false})
    for (const double factor : exact ? kExact : kRounded) {
      CAPTURE(factor);
      const Capture scaled;
      const std::vector<float> found = cut(scaled, factor);
      REQUIRE(found.size() == expected.size());
      int different = 0;
      for (std::size_t i = 0; i < found.size(); ++i) different += (found[i] >= 0.5f) != (expected[i] >= 0.5f);
      CHECK(different == 0);
      CHECK(differing_pixels(plain.dir.path() + "/m", scaled.dir.path() + "/m") <= (exact ? 0 : kMaxPixels));
    }
}

}  // namespace ngs
