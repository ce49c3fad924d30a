// Captures whose parts do not agree: what exists and is not used is always named.
#include <doctest/doctest.h>

#include "contract/captures/capture.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
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

TEST_CASE("a plain capture prints no note") {
  const Capture capture;
  const test::ProcessResult result = test::succeeded(capture.import());
  CHECK(!contains(result.err, "warning"));
}

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
  copy(capture, "images", "images_2"), copy(capture, "images", "input");
  copy(capture, "masks", "masks_sam");
  copy(capture, "sparse/0", "sparse/1");
  capture.dir.write("c/transforms.json", "{\"frames\": []}");
  check_note(capture, {"images: used for photos, not images_2, input (choose another with --images DIR)",
                       "masks: used for masks, not masks_sam", "also holds sparse/1", "also holds transforms.json"});
}

}  // namespace ngs
