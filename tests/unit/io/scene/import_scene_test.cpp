#include "ngs/io/scene/import_scene.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "ngs/core/error.h"
#include "ngs/io/files/folder_index.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/scene/scene_json.h"
#include "support/camera_files.h"
#include "support/error_code.h"
#include "support/temp_dir.h"

namespace ngs::io {
namespace {

using test::TempDir;
using test::views_named;

/// A COLMAP scene of 64x48 px photos 0.png ... in `dir`.
void make_scene(const TempDir& dir, int count, ImageSize photo = {64, 48}) {
  std::vector<std::string> names;
  for (int i = 0; i < count; ++i) names.push_back(std::to_string(i) + ".jpg.png");
  for (const std::string& name : names)
    write_png(dir.file("images/" + name), ImageU8(photo.width_px, photo.height_px, 3, 9));
  test::write_cameras(dir, "sparse/0", names);
}

void mask(const TempDir& dir, const std::string& name, std::uint8_t value = 255) {
  write_png(dir.file(name), ImageU8(64, 48, 1, value));
}

ImportRequest request_for(const TempDir& dir) {
  ImportRequest request;
  request.capture.source = dir.path();
  return request;
}

/// Two views, each with a label map of one id.
ImportRequest two_label_maps(const TempDir& dir, std::uint8_t first, std::uint8_t second) {
  make_scene(dir, 2);
  mask(dir, "masks/0.jpg.png", first);
  mask(dir, "masks/1.jpg.png", second);
  ImportRequest request = request_for(dir);
  request.mask_mode = MaskMode::kLabel;
  return request;
}

}  // namespace

TEST_CASE("a photo in one flat folder is not assigned to two cameras of a rig") {
  const TempDir dir;
  make_scene(dir, 2);
  test::write_cameras(dir, "sparse/0", {"cam0/0.png", "cam1/0.png"});
  write_png(dir.file("images/0.png"), ImageU8(64, 48, 3, 9));
  CHECK(test::code_of([&] { import_scene(request_for(dir)); }) == ErrorCode::kInconsistent);
  for (const char* name : {"images/cam0/0.png", "images/cam1/0.png"}) write_png(dir.file(name), ImageU8(64, 48, 3, 9));
  const ImportedScene got = import_scene(request_for(dir));
  CHECK(got.scene.views[1].image_path == dir.path() + "/images/cam1/0.png");
}

TEST_CASE("a folder is imported with its photos, masks and model, and notes list the choices") {
  const TempDir dir;
  make_scene(dir, 3);
  mask(dir, "masks/0.jpg.png");
  mask(dir, "masks/2.jpg.png");
  dir.write("point_cloud/iteration_7000/point_cloud.ply", "x");
  dir.write("point_cloud/iteration_30000/point_cloud.ply", "x");
  dir.write("input.ply", "x");
  const ImportedScene got = import_scene(request_for(dir));
  REQUIRE(got.scene.views.size() == 3);
  CHECK(got.format == "COLMAP text");
  CHECK(got.scene.model_path == dir.path() + "/point_cloud/iteration_30000/point_cloud.ply");
  CHECK(got.scene.views[1].image_path == dir.path() + "/images/1.jpg.png");
  CHECK(got.scene.views[1].mask_path.empty());
  CHECK(got.scene.views[2].mask_path == dir.path() + "/masks/2.jpg.png");
  CHECK(got.scene.objects.size() == 1);
  CHECK(got.views_by_mask_rule.at("<name>") == 2);
  REQUIRE(got.notes.size() == 1);
  CHECK(got.notes[0] == "no mask for 1 of 3 views (first: 1.jpg.png)");
  write_scene_json(dir.file("scene.json"), got.scene);
  CHECK(read_scene_json(dir.file("scene.json")).views[2].mask_path == got.scene.views[2].mask_path);
}

TEST_CASE("importing from the COLMAP model's folder equals importing from the scene's folder") {
  const TempDir dir;
  make_scene(dir, 1);
  for (const char* source : {"", "/", "/sparse", "/sparse/0", "/sparse/0/"}) {
    CAPTURE(source);
    ImportRequest request = request_for(dir);
    request.capture.source += source;
    CHECK(std::filesystem::exists(import_scene(request).scene.views[0].image_path));
  }
}

TEST_CASE("a scene folder may have the name of a COLMAP sub-folder") {
  const TempDir dir;
  make_scene(dir, 1);
  for (const char* name : {"colmap", "sparse", "0"}) {
    const std::string renamed = dir.path() + "/renamed/" + name + "/";
    std::filesystem::create_directories(renamed);
    for (const std::string part : {"images", "sparse"})
      std::filesystem::copy(dir.path() + "/" + part, renamed + part, std::filesystem::copy_options::recursive);
    for (const std::string below : {"", "sparse/0"}) {
      CAPTURE(renamed + below);
      ImportRequest request = request_for(dir);
      request.capture.source = renamed + below;
      CHECK(import_scene(request).scene.views[0].image_path == renamed + "images/0.jpg.png");
    }
  }
}

TEST_CASE("photos next to the cameras' folder are found from every folder of the COLMAP tree") {
  const TempDir dir;
  make_scene(dir, 1);
  std::filesystem::create_directories(dir.path() + "/colmap");
  std::filesystem::rename(dir.path() + "/sparse", dir.path() + "/colmap/sparse");
  const std::filesystem::path before = std::filesystem::current_path();
  for (const auto& place : {std::pair{"colmap/sparse/0", "."},
                            {"colmap/sparse", "0"},
                            {"colmap/sparse", "."},
                            {"colmap", "sparse/0"},
                            {"", "colmap/sparse"},
                            {"", "."}}) {
    const char *folder = place.first, *source = place.second;
    CAPTURE(folder);
    CAPTURE(source);
    std::filesystem::current_path(dir.path() + "/" + folder);
    ImportRequest request;
    request.capture.source = source;
    CHECK(std::filesystem::exists(import_scene(request).scene.views[0].image_path));
    std::filesystem::current_path(before);
  }
}

TEST_CASE("with several mask folders none is chosen") {
  const TempDir dir;
  make_scene(dir, 1);
  mask(dir, "masks_a/0.jpg.png");
  CHECK(import_scene(request_for(dir)).masks_dir == dir.path() + "/masks_a");
  mask(dir, "masks_b/0.jpg.png");
  const ImportedScene got = import_scene(request_for(dir));
  CHECK(got.masks_dir.empty());
  CHECK(std::any_of(got.notes.begin(), got.notes.end(), [](const std::string& note) {
    return note.find("several mask folders (masks_a masks_b)") != std::string::npos;
  }));
}

TEST_CASE("a ground-truth folder is not used for masks, and a guessed folder is noted") {
  const auto noted = [](const ImportedScene& got, const std::string& text) {
    return std::any_of(got.notes.begin(), got.notes.end(),
                       [&](const std::string& note) { return note.find(text) != std::string::npos; });
  };
  const TempDir dir;
  make_scene(dir, 1);
  mask(dir, "masks_gt/0.jpg.png");
  mask(dir, "gt_masks/0.jpg.png");
  const ImportedScene none = import_scene(request_for(dir));
  CHECK(none.masks_dir.empty());
  CHECK(none.scene.views[0].mask_path.empty());
  CHECK(noted(none, "/masks_gt: not read, its name suggests ground truth"));
  CHECK(noted(none, "/gt_masks: not read, its name suggests ground truth"));
  mask(dir, "masks_sam/0.jpg.png");
  const ImportedScene guessed = import_scene(request_for(dir));
  CHECK(guessed.masks_dir == dir.path() + "/masks_sam");
  CHECK(noted(guessed, "/masks_sam: used for masks because of its name"));
  mask(dir, "masks/0.jpg.png");
  const ImportedScene usual = import_scene(request_for(dir));
  CHECK(usual.masks_dir == dir.path() + "/masks");
  CHECK(noted(usual, "/masks: used for masks, not masks_sam ("));
}

TEST_CASE("masks_sam/ is preferred to other folders of masks; masks_gt/ or gt/ is recorded as the truth") {
  const TempDir dir;
  make_scene(dir, 1);
  mask(dir, "masks_sam/0.jpg.png");
  mask(dir, "masks_other/0.jpg.png");
  CHECK(import_scene(request_for(dir)).masks_dir == dir.path() + "/masks_sam");
  mask(dir, "gt/0.jpg.png");
  CHECK(import_scene(request_for(dir)).truth_dir == dir.path() + "/gt");
  mask(dir, "masks_gt/0.jpg.png");
  CHECK(import_scene(request_for(dir)).truth_dir == dir.path() + "/masks_gt");
  ImportRequest request = request_for(dir);
  request.truth_dir = "elsewhere";
  CHECK(import_scene(request).truth_dir == "elsewhere");
}

TEST_CASE("masks named by the user replace those named by the source") {
  const TempDir dir;
  for (const char* name : {"a.png", "valid/a.png", "masks/a.png", "other/a.png"}) mask(dir, name);
  dir.write("transforms.json", R"({"camera_angle_x": 1, "frames": [{"file_path": "a.png", "mask_path": "valid/a.png",
      "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}]})");
  ImportRequest request = request_for(dir);
  CHECK(import_scene(request).scene.views[0].mask_path == dir.path() + "/valid/a.png");
  request.masks_dir = dir.path() + "/other";
  const ImportedScene got = import_scene(request);
  CHECK(got.scene.views[0].mask_path == dir.path() + "/other/a.png");
  CHECK(got.views_by_mask_rule == std::map<std::string, int>{{"<name>", 1}});
  CHECK(std::any_of(got.notes.begin(), got.notes.end(), [](const std::string& note) {
    return note.find("mask_path of 1 views ignored") != std::string::npos;
  }));
}

TEST_CASE("masks that the source names and that are no files are replaced by masks/, or named") {
  const TempDir dir;
  for (const char* name : {"a.png", "masks/a.png"}) mask(dir, name);
  dir.write("transforms.json", R"({"camera_angle_x": 1, "frames": [{"file_path": "a.png", "mask_path": "lost/a.png",
      "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}]})");
  const ImportedScene replaced = import_scene(request_for(dir));
  CHECK(replaced.scene.views[0].mask_path == dir.path() + "/masks/a.png");
  CHECK(replaced.unfit_masks.found.empty());
  std::filesystem::remove_all(dir.path() + "/masks");
  CHECK(import_scene(request_for(dir)).unfit_masks.found ==
        "mask_path of 1 views is no file (first: " + dir.path() + "/lost/a.png), expected masks");
}

TEST_CASE("cameras are scaled to their photos, then by image_scale") {
  const TempDir dir;
  make_scene(dir, 1, {32, 24});
  ImportRequest request = request_for(dir);
  const Camera full = test::random_cameras(1, false)[0].camera;
  request.image_scale = 0.5;
  const Camera got = import_scene(request).scene.views[0].camera;
  CHECK((got.width_px == 16 && got.height_px == 12));
  CHECK(got.fx == doctest::Approx(full.fx / 4));
  CHECK(got.cy == doctest::Approx(full.cy / 4));
}

TEST_CASE("small photos that are reduced because of larger ones are noted") {
  const auto told = [](const ImportedScene& scene) {
    return std::count_if(scene.notes.begin(), scene.notes.end(), [](const std::string& note) {
      return note.find("2 views of at most 800 px are reduced to 1/2 of their size") == 0;
    });
  };
  const TempDir dir;
  make_scene(dir, 3);
  ImportRequest request = request_for(dir);
  request.image_scale = 0;
  CHECK(told(import_scene(request)) == 0);
  write_png(dir.file("images/1.jpg.png"), ImageU8(64 * 16, 48 * 16, 3, 9));
  const ImportedScene mixed = import_scene(request);
  CHECK(mixed.scene.image_scale == 0.5);
  CHECK(told(mixed) == 1);
  request.image_scale = 1;
  CHECK(told(import_scene(request)) == 0);
  request.image_scale = 0;
  for (const char* small : {"images/0.jpg.png", "images/2.jpg.png"})  // no small photo is left
    write_png(dir.file(small), ImageU8(64 * 16, 48 * 16, 3, 9));
  CHECK(told(import_scene(request)) == 0);
}

TEST_CASE("for a photo too narrow for its working size the error has the smallest usable scale") {
  const TempDir dir;
  test::write_cameras(dir, "sparse/0", {"a.png"}, 8000, 64);
  write_png(dir.file("images/a.png"), ImageU8(8000, 64, 3, 9));
  ImportRequest request = request_for(dir);
  request.image_scale = 0;
  const Error e = test::thrown_by([&] { import_scene(request); });
  CHECK(std::string(e.what()) == "--image-scale 0.100000: view a.png becomes 800x6 px, expected at least 8 a side");
  CHECK(e.remedy() == "--image-scale 0.125 or more keeps that of every view");
  request.image_scale = 0.125;
  CHECK(import_scene(request).scene.views[0].camera.height_px == 8);
}

TEST_CASE("photos of another aspect ratio, no photos and no masks are kInconsistent") {
  const TempDir dir;
  make_scene(dir, 1, {30, 30});
  CHECK(test::code_of([&] { import_scene(request_for(dir)); }) == ErrorCode::kInconsistent);
  const TempDir other;
  make_scene(other, 1);
  other.write("elsewhere/z.png", "x");
  ImportRequest request = request_for(other);
  request.capture.images_dir = other.path() + "/elsewhere";
  CHECK(test::code_of([&] { import_scene(request); }) == ErrorCode::kInconsistent);
  request = request_for(other);
  request.masks_dir = other.path() + "/elsewhere";
  CHECK(test::code_of([&] { import_scene(request); }) == ErrorCode::kInconsistent);
  request.masks_dir = other.path() + "/nowhere";
  CHECK(test::code_of([&] { import_scene(request); }) == ErrorCode::kBadInput);
}

TEST_CASE("photos stored rotated get another hint than photos of another aspect ratio") {
  const TempDir dir;
  make_scene(dir, 1, {48, 64});
  const auto remedy = [&] { return test::thrown_by([&] { import_scene(request_for(dir)); }).remedy(); };
  CHECK(remedy().find("EXIF orientation") != std::string::npos);
  write_png(dir.file("images/0.jpg.png"), ImageU8(50, 64, 3, 9));
  CHECK(remedy().find("calibrated on") != std::string::npos);
}

TEST_CASE("label id 255 among other ids is noted as a possible void id, and is no object with --void-id 255") {
  const TempDir dir;
  ImportRequest request = two_label_maps(dir, 7, 255);
  const auto hinted = [](const ImportedScene& imported) {
    return std::ranges::any_of(imported.notes, [](const std::string& n) { return n.find("--void-id 255") != n.npos; });
  };
  const ImportedScene both = import_scene(request);
  CHECK(both.scene.objects.size() == 2);
  CHECK(hinted(both));
  request.void_id = 255;
  const ImportedScene one = import_scene(request);
  REQUIRE(one.scene.objects.size() == 1);
  CHECK(one.scene.objects[0].id == 7);
  CHECK(one.scene.void_id == 255);
  CHECK_FALSE(hinted(one));
}

TEST_CASE("label maps give one object per id, or only the ids that are named") {
  const TempDir dir;
  ImportRequest request = two_label_maps(dir, 7, 3);
  const ImportedScene all = import_scene(request);
  REQUIRE(all.scene.objects.size() == 2);
  CHECK(all.scene.objects[0].name == "object-3");
  CHECK(all.scene.objects[1].id == 7);
  request.hold_out = "every:2:0";  // the only view with id 7
  CHECK(import_scene(request).scene.objects.size() == 1);
  request.hold_out.clear();
  request.object_ids = {"cup=7"};
  const ImportedScene one = import_scene(request);
  REQUIRE(one.scene.objects.size() == 1);
  CHECK(one.scene.objects[0].name == "cup");
  CHECK(one.scene.objects[0].id == 7);
  for (const char* wrong : {"cup", "cup=", "=7", "70000", "cup=-1"}) {
    CAPTURE(wrong);
    request.object_ids = {wrong};
    CHECK(test::code_of([&] { import_scene(request); }) == ErrorCode::kUsage);
  }
}

TEST_CASE("every:N:K holds out the views with index K modulo N, a file those it names") {
  std::vector<SceneView> views = views_named({"a.png", "b.png", "c.png", "d.png", "e.png"});
  assign_splits("every:4:2", views);
  for (std::size_t i = 0; i < 5; ++i) CHECK((views[i].split == Split::kHeldOut) == (i == 2));
  const TempDir dir;
  views = views_named({"a.png", "b.png", "c.png"});
  assign_splits(dir.write("test.txt", "# held out\r\n b.png\r\nc\n"), views);
  CHECK(views[0].split == Split::kTrain);
  CHECK(views[1].split == Split::kHeldOut);
  CHECK(views[2].split == Split::kHeldOut);
  views = views_named({"a.png", "b.png", "c.png"});
  assign_splits(dir.write("mark.txt",
                          "\xEF\xBB\xBF"
                          "a.png\r\n"),
                views);  // a byte order mark, as written by Windows editors
  CHECK(views[0].split == Split::kHeldOut);
  CHECK(test::code_of([&] { assign_splits(dir.write("t.txt", "unknown.png\n"), views); }) == ErrorCode::kInconsistent);
  CHECK(test::code_of([&] { assign_splits(dir.write("empty.txt", "# none\n"), views); }) == ErrorCode::kBadInput);
  CHECK(test::code_of([&] { assign_splits("every:1:0", views); }) == ErrorCode::kInconsistent);
  for (const char* wrong : {"every:", "every:0:0", "every:4:4", "every:4", "every:4:2:1", "every:4:-2"})
    CHECK(test::code_of([&] { assign_splits(wrong, views); }) == ErrorCode::kUsage);
}

TEST_CASE("a transforms.json that names a device as its image does not hang the reader") {
  const TempDir dir;
  dir.write("transforms.json", R"({"camera_angle_x": 1, "frames": [{"file_path": "/dev/zero",
      "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}]})");
  CHECK(test::code_of([&] { import_scene(request_for(dir)); }) == ErrorCode::kBadInput);
}

TEST_CASE("an LLFF folder takes its names from the sorted images") {
  const TempDir dir;
  const auto views = test::random_cameras(2, true);
  dir.write("poses_bounds.npy", test::llff_npy(views));
  for (const char* name : {"images/b.png", "images/a.png"}) write_png(dir.file(name), ImageU8(640, 480, 1));
  const ImportedScene got = import_scene(request_for(dir));
  CHECK(got.format == "LLFF");
  CHECK(got.scene.views[0].camera.name == "a.png");
  CHECK(got.scene.views[0].camera.translation.z == doctest::Approx(views[0].camera.translation.z));
}

TEST_CASE("a cameras.json without extensions finds its photos by stem") {
  const TempDir dir;
  auto views = test::random_cameras(1, true);
  views[0].camera.name = "IMG_1.5";
  dir.write("cameras.json", test::cameras_json(views).dump());
  write_png(dir.file("images/IMG_1.5.png"), ImageU8(320, 240, 1));
  const ImportedScene got = import_scene(request_for(dir));
  CHECK(got.scene.views[0].image_path == dir.path() + "/images/IMG_1.5.png");
  CHECK(got.scene.views[0].camera.width_px == 320);
}

}  // namespace ngs::io
