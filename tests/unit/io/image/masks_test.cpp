#include "ngs/io/image/masks.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "ngs/core/error.h"
#include "ngs/core/rng.h"
#include "ngs/io/image/exr.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/image/photo.h"
#include "support/error_code.h"
#include "support/temp_dir.h"

namespace ngs::io {
namespace {

using test::TempDir;
using Values = std::vector<float>;

Scene one_view(MaskMode mode, int width, int height, const std::string& mask) {
  Scene scene;
  scene.mask_mode = mode;
  scene.objects = {{"object", 0}};
  scene.views.push_back({Camera{"a.png", width, height}, "", mask});
  return scene;
}

std::string grey(const TempDir& dir, const std::string& name, int width, std::vector<std::uint8_t> values) {
  ImageU8 image(width, int(values.size()) / width, 1);
  image.data = std::move(values);
  write_png(dir.file(name), image);
  return dir.file(name);
}

}  // namespace

TEST_CASE("binary masks: object at and above the threshold") {
  const TempDir dir;
  Scene scene = one_view(MaskMode::kBinary, 4, 1, grey(dir, "m.png", 4, {0, 127, 128, 255}));
  CHECK(load_masks(scene, 0).target[0] == Values{0, 0, 1, 1});
  scene.mask_threshold = 127;
  CHECK(load_masks(scene, 0).target[0] == Values{0, 1, 1, 1});
  scene.mask_invert = true;
  CHECK(load_masks(scene, 0).target[0] == Values{1, 0, 0, 0});
}

TEST_CASE("binary masks: the middle value of a trimap is unknown, unless the object touches the background") {
  const TempDir dir;
  const ViewMasks trimap =
      load_masks(one_view(MaskMode::kBinary, 3, 2, grey(dir, "m.png", 3, {0, 128, 255, 0, 128, 255})), 0);
  CHECK(trimap.known == std::vector<std::uint8_t>{1, 0, 1, 1, 0, 1});
  CHECK(trimap.target[0][0] == 0);
  CHECK(trimap.target[0][2] == 1);
  for (const std::vector<std::uint8_t>& values :
       {std::vector<std::uint8_t>{0, 128, 255, 0, 255, 255},  // contact in a row
        {0, 128, 255, 255, 128, 0},                           // in a column
        {0, 128, 200, 0, 128, 255},                           // soft
        {0, 128, 128, 0, 128, 128}}) {                        // without an object
    const ViewMasks other = load_masks(one_view(MaskMode::kBinary, 3, 2, grey(dir, "o.png", 3, values)), 0);
    CHECK(other.known.empty());
    CHECK(other.target[0][1] == float(values[1] >= 128));
  }
}

TEST_CASE("one mask per file: 8 and 16 bit, grey, coloured or a cut-out; values of another range are noted") {
  struct Case {
    MaskMode mode;
    int bits, channels;
    std::vector<std::uint16_t> samples;
    Values target;
    std::string note;
  };
  constexpr MaskMode kBinary = MaskMode::kBinary, kSoft = MaskMode::kSoft;
  const TempDir dir;
  for (const Case& c : std::vector<Case>{
           {kBinary, 16, 1, {128 * 257 - 1, 128 * 257, 65535}, {0, 1, 1}, ""},
           {kSoft, 16, 1, {13107, 65535}, {0.2f, 1}, ""},
           {kBinary, 8, 1, {0, 1}, {0, 1}, "values are 0 and 1 only"},
           {kBinary, 16, 1, {0, 255}, {0, 1}, "values are 0 and 255 only"},
           {kSoft, 16, 1, {0, 255}, {0, 1}, "values are 0 and 255 only"},
           {kBinary, 16, 1, {200, 255}, {0, 0}, ""},  // a faint soft mask
           {kBinary, 8, 1, {0, 0}, {0, 0}, ""},
           {kBinary, 8, 4, {200, 10, 10, 0, 200, 10, 10, 255}, {0, 1}, "alpha channel used as the mask"},
           {kBinary, 8, 1, {0, 40, 80, 120, 160, 200}, {0, 0, 0, 0, 1, 1}, "many greys, as in a picture of depth"},
           {kBinary, 8, 3, {0, 0, 255, 0, 0, 0}, {1, 0}, "the largest of red, green and blue"},
           {kBinary, 8, 3, {0, 0, 255, 0, 0, 0, 255, 0, 0}, {1, 0, 1}, "several colours, all bright ones"}}) {
    const int width = int(c.target.size());
    INFO("mode ", int(c.mode), ", ", c.bits, " bit, channels ", c.channels, ", note ", c.note);
    if (c.bits == 16) {
      ImageU16 image(width, 1, c.channels);
      image.data = c.samples;
      write_png16(dir.file("m.png"), image);
    } else {
      ImageU8 image(width, 1, c.channels);
      image.data.assign(c.samples.begin(), c.samples.end());
      write_png(dir.file("m.png"), image);
    }
    const LoadedMasks got = load_masks_with_notes(one_view(c.mode, width, 1, dir.file("m.png")), 0);
    CHECK(got.masks.target[0] == c.target);
    REQUIRE(got.notes.size() == (c.note.empty() ? 0 : 1));
    if (!c.note.empty()) CHECK(got.notes[0].find(c.note) != std::string::npos);
  }
}

TEST_CASE("label maps give one plane per object, 8 and 16 bit") {
  const TempDir dir;
  Scene scene = one_view(MaskMode::kLabel, 4, 1, grey(dir, "m.png", 4, {0, 7, 3, 7}));
  scene.objects = {{"cup", 7}, {"spoon", 3}};
  const ViewMasks masks = load_masks(scene, 0);
  CHECK(masks.target[0] == Values{0, 1, 0, 1});
  CHECK(masks.target[1] == Values{0, 0, 1, 0});
  ImageU16 wide(2, 1, 1);
  wide.data = {300, 44};  // 300 & 255 == 44: the high byte must not be ignored
  write_png16(dir.file("w.png"), wide);
  scene = one_view(MaskMode::kLabel, 2, 1, dir.file("w.png"));
  scene.objects = {{"o", 300}};
  CHECK(load_masks(scene, 0).target[0] == Values{1, 0});
}

TEST_CASE("label maps are read from EXR by their ids, and other numbers refused") {
  const TempDir dir;
  ExrImage exr{3, 1, {{"ngs.id", {0, 300, 7}}, {"R", {1, 1, 1}}}, {}, {}};
  write_exr(dir.file("m.exr"), exr);
  Scene scene = one_view(MaskMode::kLabel, 3, 1, dir.file("m.exr"));
  scene.objects = {{"cup", 300}};
  CHECK(load_masks(scene, 0).target[0] == Values{0, 1, 0});
  CHECK(ids_in_label_map(dir.file("m.exr")) == std::set<std::uint32_t>{0, 7, 300});
  exr.channels["ngs.id"][2] = 7.5f;
  write_exr(dir.file("m.exr"), exr);
  CHECK_THROWS_WITH_AS(load_masks(scene, 0), doctest::Contains("expected ids in 0..65535"), Error);
}

TEST_CASE("a coloured label map is refused") {
  const TempDir dir;
  ImageU8 image(1, 1, 3);
  image.data = {255, 0, 0};
  write_png(dir.file("m.png"), image);
  CHECK_THROWS_WITH_AS(load_masks(one_view(MaskMode::kLabel, 1, 1, dir.file("m.png")), 0),
                       doctest::Contains("expected a label map"), Error);
}

TEST_CASE("a JPEG label map is rejected, other JPEG masks are read") {
  const TempDir dir;
  const std::vector<std::uint8_t> jpeg = encode_jpeg(ImageU8(8, 8, 3, 200), 90);
  const std::string path = dir.write("m.jpg", {reinterpret_cast<const char*>(jpeg.data()), jpeg.size()});
  CHECK_THROWS_WITH_AS(load_masks(one_view(MaskMode::kLabel, 8, 8, path), 0), doctest::Contains("changes ids"), Error);
  CHECK_THROWS_AS(ids_in_label_map(path), Error);
  CHECK(load_masks_with_notes(one_view(MaskMode::kBinary, 8, 8, path), 0).lossy);
}

TEST_CASE("masks of an EXR are its soft mask") {
  const TempDir dir;
  ExrImage exr{2, 1, {{"Z", {5, 5}}, {"ngs.mask", {0.25f, 0.75f}}}, {}, {}};
  write_exr(dir.file("m.exr"), exr);
  CHECK(load_masks(one_view(MaskMode::kSoft, 2, 1, dir.file("m.exr")), 0).target[0] == Values{0.25f, 0.75f});
  CHECK(load_masks(one_view(MaskMode::kBinary, 2, 1, dir.file("m.exr")), 0).target[0] == Values{0, 1});
  exr.channels["ngs.mask"][0] = 1.5f;
  write_exr(dir.file("m.exr"), exr);
  CHECK_THROWS_AS(load_masks(one_view(MaskMode::kSoft, 2, 1, dir.file("m.exr")), 0), Error);
}

TEST_CASE("the three bands are unknown, background and object, with LichtFeld's borders") {
  const TempDir dir;
  Scene scene = one_view(MaskMode::kBands, 5, 1, grey(dir, "m.png", 5, {0, 127, 128, 250, 251}));
  ViewMasks masks = load_masks(scene, 0);
  CHECK(masks.target[0] == Values{0, 0, 0, 0, 1});
  CHECK(masks.known == std::vector<std::uint8_t>{0, 0, 1, 1, 1});
  scene.mask_invert = true;  // swaps object and background, never the unknown
  masks = load_masks(scene, 0);
  CHECK(masks.target[0] == Values{0, 0, 1, 1, 0});
  CHECK(masks.known == std::vector<std::uint8_t>{0, 0, 1, 1, 1});
}

TEST_CASE("a binary mask twice as large is reduced by majority, the object wins a tie") {
  const TempDir dir;
  // columns of 2x2 blocks: 1 of 4, 2 of 4, 3 of 4 object
  const std::string path = grey(dir, "m.png", 6, {255, 0, 255, 0, 255, 255, 0, 0, 0, 255, 255, 0});
  const LoadedMasks got = load_masks_with_notes(one_view(MaskMode::kBinary, 3, 1, path), 0);
  CHECK(got.masks.target[0] == Values{0, 1, 1});
  CHECK(got.resized);
  CHECK(got.notes[0].find("6x2 px resampled to the camera's 3x1 px") != std::string::npos);
}

TEST_CASE("a label map is reduced to the label with the largest share") {
  const TempDir dir;
  Scene scene = one_view(MaskMode::kLabel, 1, 1, grey(dir, "m.png", 3, {1, 1, 1, 2, 2, 2, 2, 0, 0}));
  scene.objects = {{"a", 1}, {"b", 2}};
  const ViewMasks masks = load_masks(scene, 0);
  CHECK(masks.target[0] == Values{0});
  CHECK(masks.target[1] == Values{1});
}

TEST_CASE("fast reduction of a label map equals the reduction of its objects' planes, including ties and other ids") {
  const TempDir dir;
  for (const int scale : {2, 4})
    for (int seed = 0; seed < 3; ++seed) {
      CAPTURE(scale);
      const int w = 24, h = 18;
      std::vector<std::uint8_t> ids;
      for (int y = 0; y < h * scale; ++y)
        for (int x = 0; x < w * scale; ++x) {
          const double noise = rng_uniform(std::uint64_t(seed), RngStream::kTest, ids.size());
          ids.push_back(noise < 0.7 ? std::uint8_t(x / 9 % 5) : std::uint8_t(noise * 10));
        }
      Scene scene = one_view(MaskMode::kLabel, w, h, grey(dir, "m.png", w * scale, ids));
      scene.objects = {{"c", 2}, {"a", 0}, {"b", 3}, {"nowhere", 65535}};
      const LoadedMasks at_once = load_masks_with_notes(scene, 0);
      scene.void_id = 200;  // no pixel has it, but the slow path is taken
      const LoadedMasks by_plane = load_masks_with_notes(scene, 0);
      CHECK(at_once.masks.target == by_plane.masks.target);
      CHECK(at_once.resized);
      CHECK(at_once.notes == by_plane.notes);
      for (const std::size_t k : {0, 1, 2}) {
        const Values& target = at_once.masks.target[k];
        const auto pixels = std::ranges::count(target, 1.f);
        CHECK(pixels > 20);
        CHECK(pixels < std::ssize(target) / 2);
      }
    }
}

TEST_CASE("unknown pixels of label maps and bands are no evidence, and not background in reductions") {
  const TempDir dir;
  Scene scene = one_view(MaskMode::kLabel, 4, 1, grey(dir, "m.png", 4, {0, 7, 255, 7}));
  scene.objects = {{"cup", 7}};
  CHECK(load_masks(scene, 0).known.empty());
  scene.void_id = 255;
  const ViewMasks masks = load_masks(scene, 0);
  CHECK(masks.target[0] == Values{0, 1, 0, 1});
  CHECK(masks.known == std::vector<std::uint8_t>{1, 1, 0, 1});
  // 4 of 9 object, 2 background, 3 unknown; then 4 of 9 object and 5 unknown
  scene = one_view(MaskMode::kLabel, 2, 1,
                   grey(dir, "n.png", 6, {7, 7, 0, 7, 7, 255, 7, 7, 0, 255, 255, 255, 255, 255, 255, 7, 7, 255}));
  scene.objects = {{"cup", 7}};
  scene.void_id = 255;
  const ViewMasks reduced = load_masks(scene, 0);
  CHECK(reduced.target[0] == Values{1, 1});
  CHECK(reduced.known == std::vector<std::uint8_t>{1, 0});
  scene = one_view(MaskMode::kBands, 1, 1, grey(dir, "b.png", 3, {255, 255, 0, 255, 255, 0, 200, 200, 0}));
  CHECK(load_masks(scene, 0).target[0] == Values{1});
}

TEST_CASE("a soft mask is reduced by area, a smaller mask is enlarged by nearest") {
  const TempDir dir;
  CHECK(load_masks(one_view(MaskMode::kSoft, 1, 1, grey(dir, "m.png", 2, {0, 255, 0, 0})), 0).target[0] ==
        Values{0.25f});
  CHECK(load_masks(one_view(MaskMode::kBinary, 4, 2, grey(dir, "n.png", 2, {0, 255})), 0).target[0] ==
        Values{0, 0, 1, 1, 0, 0, 1, 1});
}

TEST_CASE("masks of the full-size photos suit cameras at image_scale") {
  const TempDir dir;
  Scene scene = one_view(MaskMode::kBinary, 3, 3, grey(dir, "m.png", 4, std::vector<std::uint8_t>(16, 255)));
  CHECK_THROWS_AS(load_masks(scene, 0), Error);
  scene.image_scale = 0.75;
  CHECK(load_masks(scene, 0).target[0] == Values(9, 1.f));
}

TEST_CASE("a mask of another aspect ratio is rejected with both sizes") {
  const TempDir dir;
  const Scene scene = one_view(MaskMode::kBinary, 4, 3, grey(dir, "m.png", 5, {0, 0, 0, 0, 0}));
  CHECK_THROWS_WITH_AS(load_masks(scene, 0), doctest::Contains("mask of 5x1 px for view a.png of 4x3 px"), Error);
}

TEST_CASE("a rotated mask gets another hint than one of another aspect ratio") {
  const TempDir dir;
  const auto remedy = [&](int width, int height) {
    write_png(dir.file("m.png"), ImageU8(width, height, 1));
    return test::thrown_by([&] { load_masks(one_view(MaskMode::kBinary, 400, 300, dir.file("m.png")), 0); }).remedy();
  };
  CHECK(remedy(300, 400).find("EXIF orientation") != std::string::npos);
  CHECK(remedy(600, 800).find("EXIF orientation") != std::string::npos);
  CHECK(remedy(300, 410).find("photos that the scene names") != std::string::npos);
  CHECK(remedy(400, 225).find("mogrify -gravity center -background black -extent 400x300 ") != std::string::npos);
  const std::string square = remedy(1024, 1024);
  CHECK(square.find("mogrify -resize '1024x768!' ") != std::string::npos);
  CHECK(square.find("mogrify -crop 1024x768+0+0 +repage ") != std::string::npos);
}

TEST_CASE("a missing mask is unknown, empty or an error, according to missing_mask") {
  Scene scene = one_view(MaskMode::kBinary, 2, 2, "");
  CHECK_FALSE(load_masks(scene, 0).available);
  scene.missing_mask = MissingMask::kEmpty;
  CHECK(load_masks(scene, 0).available);
  CHECK(load_masks(scene, 0).target[0] == Values(4, 0.f));
  scene.missing_mask = MissingMask::kError;
  CHECK_THROWS_WITH_AS(load_masks(scene, 0), doctest::Contains("view a.png: no mask"), Error);
}

TEST_CASE("one folder per object gives one plane per object, and an absent file makes the view unknown") {
  const TempDir dir;
  grey(dir, "cup/a.png", 2, {255, 0});
  grey(dir, "spoon/a.png", 2, {0, 255});
  Scene scene = one_view(MaskMode::kBinary, 2, 1, dir.path() + "/{object}/a.png");
  scene.objects = {{"cup", 0}, {"spoon", 0}};
  CHECK(load_masks(scene, 0).target == std::vector<Values>{{1, 0}, {0, 1}});
  scene.objects.push_back({"fork", 0});
  CHECK_FALSE(load_masks(scene, 0).available);
  scene.missing_mask = MissingMask::kEmpty;
  CHECK(load_masks(scene, 0).target == std::vector<Values>{{1, 0}, {0, 1}, {0, 0}});
}

TEST_CASE("colours of transparent pixels do not affect the reduced photo") {
  const TempDir dir;
  Scene scene = one_view(MaskMode::kBinary, 1, 1, "");
  ImageU8 rgba(2, 1, 4);
  rgba.data = {255, 0, 0, 255, /* green, but not there */ 0, 255, 0, 0};
  scene.views[0].image_path = dir.file("p.png");
  write_png(scene.views[0].image_path, rgba);
  CHECK(photo_is_transparent(scene, 0));
  CHECK(load_photo(scene, 0).data == std::vector<float>{0.5f, 0, 0});
  scene.background = Vec3<double>{1, 1, 1};
  CHECK(load_photo(scene, 0).data == std::vector<float>{1, 0.5f, 0.5f});
  CHECK(load_fine_photo(scene, 0).data == std::vector<float>{1, 0, 0, 1, 1, 1});
}

TEST_CASE("a photo is reduced by area to the camera, and never enlarged") {
  const TempDir dir;
  Scene scene = one_view(MaskMode::kBinary, 2, 1, "");
  CHECK(load_photo(scene, 0).empty());
  scene.views[0].image_path = grey(dir, "p.png", 4, {0, 255, 255, 255, 0, 255, 255, 255});
  const ImageF photo = load_photo(scene, 0);
  CHECK(photo.width_px == 2);
  CHECK(photo.at(0, 0, 1) == doctest::Approx(0.5));
  scene.views[0].camera.width_px = 8;
  scene.views[0].camera.height_px = 4;
  CHECK_THROWS_WITH_AS(load_photo(scene, 0), doctest::Contains("expected the camera's 8x4 px"), Error);
}

}  // namespace ngs::io
