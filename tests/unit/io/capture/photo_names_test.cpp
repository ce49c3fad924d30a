#include "ngs/io/capture/photo_names.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "ngs/core/error.h"
#include "ngs/io/capture/capture_source.h"
#include "ngs/io/capture/colmap.h"
#include "ngs/io/capture/transforms_json.h"
#include "ngs/io/image/image_file.h"
#include "support/camera_files.h"
#include "support/error_code.h"
#include "support/temp_dir.h"

namespace ngs::io {
namespace {

using test::TempDir, test::write_cameras;

void write_photo(const TempDir& dir, const std::string& name) { write_png(dir.file(name), ImageU8(64, 48, 3, 9)); }

CaptureSource read(const TempDir& dir) {
  CaptureRequest request;
  request.source = dir.path();
  return read_capture(request);
}

/// The first note with this text; empty: none.
std::string note_with(const CaptureSource& source, const std::string& text) {
  const auto& notes = source.capture.notes;
  const auto found = std::ranges::find_if(notes, [&](const auto& note) { return note.find(text) != note.npos; });
  return found == notes.end() ? std::string() : *found;
}

}  // namespace

TEST_CASE("cameras with HEIC, DNG or AVIF names match copies in another format, with a note") {
  for (const char* ending : {".HEIC", ".heif", ".dng", ".avif", ".JXL", ".cr2"}) {
    CAPTURE(ending);
    const TempDir dir;
    write_cameras(dir, "sparse/0", {std::string("a b.1") + ending});
    write_photo(dir, "images/a b.1.png");
    dir.write(std::string("images/a b.1") + ending, "not to be read");
    const CaptureSource got = read(dir);
    CHECK(got.capture.views[0].image_path == dir.path() + "/images/a b.1.png");
    CHECK(note_with(got, "another file extension").find("1 photos have") == 0);
  }
}

TEST_CASE("a photo that exists only in an unsupported format is rejected with the command that converts it") {
  for (const auto& file : {std::pair("0.HEIC", "any bytes that are long enough"),
                           std::pair("0.jpg", "\1\1\1\1ftypheic\1\1\1\1\1\1\1\1\1\1")}) {
    const char *const name = file.first, *const bytes = file.second;
    CAPTURE(name);
    const TempDir dir;
    write_cameras(dir, "sparse/0", {name});
    dir.write(std::string("images/") + name, bytes);
    test::refused([&] { read(dir); }, ErrorCode::kBadInput,
                  std::string(name) + ": a photo in a format that is not read", "mogrify");
  }
}

TEST_CASE("backslashes in COLMAP names become slashes, unless a file has that exact name") {
  const TempDir dir;
  write_cameras(dir, "sparse/0", {"cam1\\0.png", "cam0\\0.png", "C:\\scan\\images\\7.png"});
  for (const char* photo : {"images/cam0/0.png", "images/cam1/0.png", "images/7.png"}) write_photo(dir, photo);
  const CaptureSource got = read(dir);
  REQUIRE(got.capture.views.size() == 3);
  CHECK(got.capture.views[0].image_path == dir.path() + "/images/7.png");
  CHECK(got.capture.views[1].camera.name == "cam0/0.png");  // sorted again
  CHECK(got.capture.views[1].image_path == dir.path() + "/images/cam0/0.png");
  CHECK(got.capture.views[2].image_path == dir.path() + "/images/cam1/0.png");

  const TempDir strange;
  write_cameras(strange, "sparse/0", {"a\\0.png"});
  write_photo(strange, "images/a\\0.png");
  CHECK(read(strange).capture.views[0].camera.name == "a\\0.png");
}

TEST_CASE("photos in the cameras' folder are found if there is no image folder") {
  for (const char* folder : {"", "sparse/0"}) {
    CAPTURE(folder);
    const TempDir dir;
    write_cameras(dir, folder, {"0.jpg", "1.jpg"});
    for (const char* photo : {"0.jpg.mask.png", "0.png", "1.png"})
      write_photo(dir, (std::filesystem::path(folder) / photo).string());
    const CaptureSource got = read(dir);
    CHECK(std::filesystem::path(got.capture.views[0].image_path).filename() == "0.png");
    CHECK(note_with(got, "no photo") == "");
    CHECK(note_with(got, "images without a camera") == "");  // masks are not counted
  }
}

TEST_CASE("upper-case folder names and extensions are found") {
  const TempDir dir;
  write_cameras(dir, "sparse/0", {"Übung 1.png", "b.png"});
  write_photo(dir, "Images/Übung 1.PNG");
  write_photo(dir, "Images/b.PNG");
  const CaptureSource got = read(dir);
  CHECK(got.capture.views[0].image_path != "");
  CHECK(got.capture.views[1].image_path != "");
  CHECK(note_with(got, "another file extension") == "");
}

TEST_CASE("unused images next to the cameras are noted") {
  const TempDir dir;
  write_cameras(dir, "sparse/0", {"0.png", "1.png"});
  write_photo(dir, "images/0.png");
  write_photo(dir, "images/5.png");
  write_photo(dir, "photos/1.png");
  write_photo(dir, "masks/1.png");
  const CaptureSource got = read(dir);
  CHECK(note_with(got, "no photo for 1 of 2 views (first: 1.png)") != "");
  CHECK(note_with(got, "/images: 1 images without a camera (first: 5.png)") != "");
  CHECK(note_with(got, "--images " + dir.path() + "/photos") != "");
  CHECK(note_with(got, "/masks") == "");
}

TEST_CASE("transforms.json: with absolute and relative image paths names are relative to the common folder") {
  const auto views = test::random_cameras(2, false);
  for (const int absolute : {0, 1}) {
    nlohmann::json root = test::transforms_json(views);
    root["frames"][std::size_t(absolute)]["file_path"] = "/data/images/1.png";
    root["frames"][std::size_t(1 - absolute)]["file_path"] = "images/2.png";
    const Capture capture = parse_transforms_json(root, test::no_images());
    CHECK(capture.views[0].camera.name == "1.png");
    CHECK(capture.views[1].camera.name == "2.png");
    CHECK(capture.views[1].image_path == "/data/images/2.png");
    root["frames"][std::size_t(absolute)]["file_path"] = "/elsewhere/1.png";
    CHECK(parse_transforms_json(root, test::no_images()).views[1].camera.name == "elsewhere/1.png");
  }
}

TEST_CASE("transforms.json: backslashes separate folders, unless a file has that exact name") {
  nlohmann::json root = test::transforms_json(test::random_cameras(2, false));
  root["frames"][0]["file_path"] = R"(.\images\left\1.png)";
  root["frames"][0]["mask_path"] = R"(masks\1.png)";
  root["frames"][1]["file_path"] = R"(images\right\1.png)";
  TransformsSource source = test::no_images();
  Capture capture = parse_transforms_json(root, source);
  CHECK(capture.views[0].camera.name == "left/1.png");
  CHECK(capture.views[1].image_path == "/data/images/right/1.png");
  CHECK(capture.views[0].mask_path == "/data/masks/1.png");
  source.images.exists = [](const std::string& path) { return path == R"(/data/images\right\1.png)"; };
  capture = parse_transforms_json(root, source);
  CHECK(capture.views[1].image_path == R"(/data/images\right\1.png)");
}

TEST_CASE("transforms.json: a frame without size and image has the size of the others, or is left out if they differ") {
  nlohmann::json root = test::transforms_json(test::random_cameras(3, false));
  root.erase("w");
  root.erase("h");
  for (auto& frame : root["frames"]) {
    frame.erase("w");
    frame.erase("h");
  }
  for (int i = 0; i < 3; ++i) root["frames"][std::size_t(i)]["file_path"] = "images/" + std::to_string(i) + ".png";
  TransformsSource source = test::no_images();
  source.images.exists = [](const std::string& path) {
    return path == "/data/images/0.png" || path == "/data/images/2.png";
  };
  source.images.size = [](const std::string&) { return ImageSize{64, 48}; };
  Capture capture = parse_transforms_json(root, source);
  REQUIRE(capture.views.size() == 3);
  REQUIRE(!capture.notes.empty());
  CHECK(capture.views[1].camera.width_px == 64);
  CHECK(capture.notes.back().find("the size of the others is used (/data/images/1.png)") != std::string::npos);
  source.images.size = [](const std::string& path) { return ImageSize{64, path.ends_with("0.png") ? 48 : 32}; };
  capture = parse_transforms_json(root, source);
  REQUIRE(capture.views.size() == 2);
  CHECK(capture.views[1].camera.name == "2.png");
  CHECK(capture.notes.back().find("are left out") != std::string::npos);
  CHECK_THROWS_WITH_AS(parse_transforms_json(root, test::no_images()), doctest::Contains("expected a size"), Error);
}

TEST_CASE("COLMAP names that are absolute or lead out of the folder become relative to the folder that all share") {
  const std::string camera = "1 SIMPLE_RADIAL 640 480 500 320 240 0.1\n", pose = " 1 0 0 0 0 0 0 1 ";
  const auto names_of = [&](const std::string& a, const std::string& b) {
    const Capture capture =
        parse_colmap_text(camera, "1" + pose + a + "\n\n2" + pose + b + "\n\n", "m", Distortion::kKept);
    CHECK(capture.lenses.size() == 2);
    CHECK(capture.lenses.contains(capture.views[0].camera.name));
    CHECK(capture.notes.size() == 1);
    return capture.views[0].camera.name + " " + capture.views[1].camera.name;
  };
  CHECK(names_of("/data/images/a.png", "/data/images/b.png") == "a.png b.png");
  CHECK(names_of("../images/left/a.png", "../images/right/a.png") == "left/a.png right/a.png");
  CHECK(names_of("C:/scan/a.png", "C:/scan/b/a.png") == "a.png b/a.png");
  CHECK(names_of("a.png", "/data/images/b.png") == "a.png b.png");
}

}  // namespace ngs::io
