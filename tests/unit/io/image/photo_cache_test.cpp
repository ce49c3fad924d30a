#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include "ngs/core/error.h"
#include "ngs/io/image/photo.h"
#include "support/temp_dir.h"

namespace ngs::io {
namespace {

/// Three views with photos of 6 x 4 px, 72 bytes each in 8 bit.
struct Photos {
  test::TempDir dir;
  Scene scene;

  Photos() {
    for (int v = 0; v < 3; ++v) {
      SceneView& view = scene.views.emplace_back();
      view.camera.width_px = 6, view.camera.height_px = 4;
      view.image_path = dir.file(std::to_string(v) + ".png");
      ImageU8 image(6, 4, 3);
      for (std::size_t i = 0; i < image.data.size(); ++i) image.data[i] = std::uint8_t(60 * v + int(i) % 50);
      write_png(view.image_path, image);
    }
  }
  void remove(std::size_t view) const { std::filesystem::remove(scene.views[view].image_path); }
};

}  // namespace

TEST_CASE("a cached photo is decoded once, with the colours of its file") {
  const Photos photos;
  const ImageF first = load_photo(photos.scene, 0), last = load_photo(photos.scene, 2);
  PhotoCache cache(photos.scene, {0, 2});
  CHECK(cache.load(0).data == first.data);
  CHECK(cache.load(1).data == load_photo(photos.scene, 1).data);
  CHECK(cache.load(2).data == last.data);
  CHECK(cache.cache_bytes() == 2 * 72);  // cached as bytes, not as floats
  for (const std::size_t v : {0, 1, 2}) photos.remove(v);
  CHECK(cache.load(0).data == first.data);
  CHECK(cache.load(2).data == last.data);
  CHECK(cache.cache_bytes() == 2 * 72);
  CHECK_THROWS_AS(cache.load(1), Error);  // view 1 was not to be cached
}

TEST_CASE("photos beyond the memory limit are decoded on each load") {
  const Photos photos;
  PhotoCache cache(photos.scene, {0, 1, 2}, 2 * 72 + 71);
  for (const std::size_t v : {1, 0, 2}) CHECK(cache.load(v).data == load_photo(photos.scene, v).data);
  CHECK(cache.cache_bytes() == 2 * 72);
  for (const std::size_t v : {0, 1, 2}) photos.remove(v);
  CHECK(cache.load(1).width_px == 6);
  CHECK(cache.load(0).width_px == 6);
  CHECK_THROWS_AS(cache.load(2), Error);
}

}  // namespace ngs::io
