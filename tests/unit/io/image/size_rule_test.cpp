// Which sizes of photos and masks are accepted for a camera, and the working size.

#include "ngs/io/image/size_rule.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "ngs/io/image/masks.h"
#include "ngs/io/image/photo.h"
#include "ngs/io/scene/import_scene.h"
#include "ngs/io/scene/scene_json.h"
#include "support/camera_files.h"
#include "support/temp_dir.h"

namespace ngs::io {
namespace {

using test::TempDir;

/// COLMAP files with one camera, 0.png, in `dir`; the import chooses the working size.
ImportRequest one_camera(const TempDir& dir, ImageSize size) {
  test::write_cameras(dir, "sparse/0", {"0.png"}, size.width_px, size.height_px);
  ImportRequest request;
  request.capture.source = dir.path();
  request.image_scale = 0;
  return request;
}

}  // namespace

TEST_CASE("sizes: equal, integer factors and image_scale are allowed, others are not") {
  CHECK(relate_sizes({10, 8}, {10, 8}, 1).same);
  CHECK(relate_sizes({20, 16}, {10, 8}, 1).allowed);
  CHECK(relate_sizes({5, 4}, {10, 8}, 1).allowed);
  CHECK(relate_sizes({4032, 3024}, {504, 378}, 1).allowed);
  CHECK(relate_sizes({1023, 767}, {511, 383}, 1).allowed);  // floor
  CHECK(relate_sizes({1023, 767}, {512, 384}, 1).allowed);  // round
  CHECK_FALSE(relate_sizes({15, 12}, {10, 8}, 1).allowed);
  CHECK(relate_sizes({1000, 800}, {300, 240}, 0.3).allowed);
  CHECK(relate_sizes({250, 200}, {300, 240}, 0.3).allowed);  // masks of images_4, cameras at 0.3
  CHECK_FALSE(relate_sizes({8, 10}, {10, 8}, 1).allowed);
  CHECK_FALSE(relate_sizes({20, 8}, {10, 8}, 1).allowed);
}

TEST_CASE("sizes of equal aspect ratio are allowed with any factor; other aspect ratios and crops are not") {
  for (const ImageSize file : {ImageSize{1600, 1200}, {1080, 810}, {853, 640}, {640, 480}, {4200, 3150}})
    for (const auto& [a, b] : {std::pair(file, ImageSize{4000, 3000}), std::pair(ImageSize{4000, 3000}, file)}) {
      CAPTURE(to_string(file));
      CHECK(relate_sizes(a, b, 1).allowed);
      CHECK(relate_mask_size(a, b, 1).allowed);
    }
  CHECK(relate_mask_size({854, 480}, {1920, 1080}, 1).allowed);      // a tracker at 480p
  CHECK(relate_mask_size({854, 480}, {640, 360}, 1.0 / 3).allowed);  // and at the working size
  CHECK(relate_mask_size({480, 854}, {1080, 1920}, 1).allowed);
  CHECK_FALSE(relate_mask_size({640, 480}, {1920, 1080}, 1).allowed);
  CHECK_FALSE(relate_mask_size({480, 854}, {1920, 1080}, 1).allowed);
  CHECK_FALSE(relate_sizes({1026, 770}, {1024, 768}, 1).allowed);  // cropped
  CHECK_FALSE(relate_sizes({40000, 30000}, {1000, 750}, 1).allowed);
}

TEST_CASE("a mask may be 1 px off the photo's or the camera's size, at any working size; a photo may not") {
  const ImageSize photo{1024, 768};
  for (const double scale : {1.0, 0.75, 0.5, 1.0 / 3, 0.3}) {
    CAPTURE(scale);
    const ImageSize camera{scaled_size_px(photo.width_px, scale), scaled_size_px(photo.height_px, scale)};
    for (const int off : {-1, 0, 1}) {
      CAPTURE(off);
      CHECK(relate_mask_size({photo.width_px + off, photo.height_px}, camera, scale).allowed);
      CHECK(relate_mask_size({photo.width_px, photo.height_px + off}, camera, scale).allowed);
      CHECK(relate_mask_size({camera.width_px + off, camera.height_px}, camera, scale).allowed);
    }
    CHECK_FALSE(relate_mask_size({photo.height_px, photo.width_px}, camera, scale).allowed);
    CHECK_FALSE(relate_mask_size({photo.width_px + 6, photo.height_px}, camera, scale).allowed);
  }
  CHECK_FALSE(relate_mask_size({1026, 768}, photo, 1).allowed);
  CHECK_FALSE(relate_mask_size({51, 40}, {50, 40}, 1).allowed);
  CHECK_FALSE(relate_sizes({1025, 768}, photo, 1).allowed);
  CHECK_FALSE(relate_mask_size({1025, 768}, photo, 1).same);
}

TEST_CASE("the working size is the photo size divided by the smallest integer that gives at most 800 px") {
  const struct {
    int photo_px, working_px;
  } cases[] = {{800, 800},  {801, 401},  {1024, 512}, {1600, 800}, {1601, 534},
               {1604, 535}, {4032, 672}, {3200, 800}, {6400, 800}, {12000, 800}};
  for (const auto& c : cases) {
    CAPTURE(c.photo_px);
    const TempDir dir;
    CHECK(import_scene(one_camera(dir, {c.photo_px, 300})).scene.views[0].camera.width_px == c.working_px);
  }
}

TEST_CASE("a scene of odd size at image_scale 1/3: photos, masks and full size agree") {
  const TempDir dir;
  const ImportRequest request = one_camera(dir, {1604, 1069});
  const double focal = test::random_cameras(1, false)[0].camera.fx;
  write_png(dir.file("images/0.png"), ImageU8(1604, 1069, 3, 9));
  for (const ImageSize size : {ImageSize{1604, 1069}, {802, 535}, {802, 534}, {535, 356}, {534, 356}, {1605, 1069}}) {
    CAPTURE(to_string(size));
    write_png(dir.file("masks/0.png"), ImageU8(size.width_px, size.height_px, 1, 255));
    const Scene scene = import_scene(request).scene;
    CHECK((scene.views[0].camera.width_px == 535 && scene.views[0].camera.height_px == 356));
    CHECK(scene.views[0].camera.fx == doctest::Approx(focal * 535 / 1604));
    CHECK(full_size(scene, 0) == ImageSize{1604, 1069});
    CHECK(load_photo(scene, 0).width_px == 535);
    CHECK(load_fine_photo(scene, 0).width_px == 1070);
    const ViewMasks masks = load_masks(scene, 0);
    CHECK(std::count(masks.target[0].begin(), masks.target[0].end(), 1.f) == 535 * 356);
    write_scene_json(dir.file("scene.json"), scene);
    CHECK(full_size(read_scene_json(dir.file("scene.json")), 0) == ImageSize{1604, 1069});
  }
}

TEST_CASE("photos and masks with a non-integer size ratio are resampled to one size") {
  const TempDir dir;
  const ImportRequest request = one_camera(dir, {240, 180});
  write_png(dir.file("images/0.png"), ImageU8(96, 72, 3, 9));
  ImageU8 mask(144, 108, 1, 0);
  for (int y = 0; y < 108; ++y)
    for (int x = 0; x < 72; ++x) mask.at(x, y) = 255;
  write_png(dir.file("masks/0.png"), mask);
  const ImportedScene got = import_scene(request);
  CHECK(got.scene.views[0].camera.width_px == 96);
  CHECK(std::ranges::any_of(got.notes, [](const std::string& note) {
    return note.find("1 cameras of 240x180 px scaled to the photos' 96x72 px") != note.npos;
  }));
  const LoadedMasks loaded = load_masks_with_notes(got.scene, 0);
  const std::vector<float>& target = loaded.masks.target[0];
  CHECK(std::count(target.begin(), target.end(), 1.f) == 48 * 72);  // the left half, as in the file
  REQUIRE(loaded.notes.size() == 1);
  CHECK(loaded.notes[0].find("mask of 144x108 px resampled to the camera's 96x72 px") != std::string::npos);
}

TEST_CASE("the full size of a view without a photo is the camera's size / image_scale") {
  Scene scene;
  scene.views.push_back({Camera{"", 14, 11}, "", ""});
  scene.image_scale = 0.3;
  CHECK(full_size(scene, 0) == ImageSize{47, 37});
  const TempDir dir;
  scene.views[0].image_path = dir.file("a.png");
  write_png(scene.views[0].image_path, ImageU8(48, 36, 3, 9));
  CHECK(full_size(scene, 0) == ImageSize{48, 36});
  write_png(scene.views[0].image_path, ImageU8(36, 48, 3, 9));  // another image
  CHECK(full_size(scene, 0) == ImageSize{47, 37});
}

}  // namespace ngs::io
