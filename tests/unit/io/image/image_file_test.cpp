#include "ngs/io/image/image_file.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "ngs/core/error.h"
#include "ngs/io/image/photo.h"
#include "support/temp_dir.h"

namespace ngs::io {
namespace {

using test::TempDir;

std::string crc_chunk(const std::string& type, const std::string& data) {
  std::uint32_t crc = ~0u;
  for (const char c : type + data) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) ? 0xEDB88320u : 0u);
  }
  const auto be = [](std::uint32_t v) { return std::string{char(v >> 24), char(v >> 16), char(v >> 8), char(v)}; };
  return be(std::uint32_t(data.size())) + type + data + be(~crc);
}

/// A PNG with stored (uncompressed) deflate data; rows hold the filter byte and packed samples.
std::string raw_png(int width, int height, int bits, int colour_type, const std::string& rows,
                    const std::string& palette) {
  std::uint32_t a = 1, b = 0;
  for (const char c : rows) {
    a = (a + static_cast<unsigned char>(c)) % 65521;
    b = (b + a) % 65521;
  }
  const auto n = std::uint16_t(rows.size());
  const auto inverse = std::uint16_t(~n);
  const std::string zlib =
      std::string{0x78, 0x01, 0x01, char(n & 255), char(n >> 8), char(inverse & 255), char(inverse >> 8)} + rows +
      std::string{char(b >> 8), char(b), char(a >> 8), char(a)};
  const std::string header{0, 0, 0, char(width), 0, 0, 0, char(height), char(bits), char(colour_type), 0, 0, 0};
  return "\x89PNG\r\n\x1a\n" + crc_chunk("IHDR", header) + (palette.empty() ? "" : crc_chunk("PLTE", palette)) +
         crc_chunk("IDAT", zlib) + crc_chunk("IEND", "");
}

}  // namespace

TEST_CASE(
    "a photo of the camera's size is held as the samples of its file, any other as floats, with the same colours") {
  const TempDir dir;
  Scene scene;
  scene.background = Vec3<double>{0.25, 0.5, 1};
  scene.image_scale = 0.5;
  struct Case {
    int channels, bits, width_px;
    std::size_t bytes_per_pixel;
  };
  for (const Case& c : {Case{3, 8, 6, 3}, Case{1, 8, 6, 1}, Case{4, 8, 6, 4}, Case{3, 16, 6, 6}, Case{3, 8, 12, 12},
                        Case{4, 16, 12, 12}}) {
    const int channels = c.channels, bits = c.bits, width_px = c.width_px;
    CAPTURE(channels);
    CAPTURE(bits);
    CAPTURE(width_px);
    const std::string path = dir.file("photo.png");
    ImageU8 small(width_px, width_px / 6 * 4, channels);
    ImageU16 large(width_px, width_px / 6 * 4, channels);
    for (std::size_t i = 0; i < small.data.size(); ++i) {
      small.data[i] = std::uint8_t(i * 37);
      large.data[i] = std::uint16_t(i * 9377);
    }
    if (bits == 8)
      write_png(path, small);
    else
      write_png16(path, large);
    scene.views.assign(1, {Camera{"", 6, 4}, path, ""});
    const PackedPhoto held = read_packed_photo(scene, 0);
    CHECK(held.bytes() == 24 * c.bytes_per_pixel);
    if (channels == 3) CHECK(packed_photo_bytes(scene, 0) == double(held.bytes()));
    const ImageF whole = read_image_rgb(path, {0.25f, 0.5f, 1.f});
    CHECK(held.rgb().data == resize_area(whole, 6, 4).data);
    CHECK(load_photo(scene, 0).data == held.rgb().data);
  }
  scene.views[0].image_path.clear();
  CHECK(read_packed_photo(scene, 0).empty());
  CHECK(load_photo(scene, 0).empty());
  CHECK(packed_photo_bytes(scene, 0) == 0);
}

TEST_CASE("a PNG is read back as written, 8 and 16 bit, 1, 3 and 4 channels") {
  const TempDir dir;
  for (const int channels : {1, 3, 4}) {
    ImageU8 small(3, 2, channels);
    ImageU16 large(3, 2, channels);
    for (std::size_t i = 0; i < small.data.size(); ++i) {
      small.data[i] = std::uint8_t(i * 11);
      large.data[i] = std::uint16_t(i * 2741 + 1);
    }
    write_png(dir.file("a.png"), small);
    write_png16(dir.file("b.png"), large);
    const RawMask a = read_mask_raw(dir.file("a.png"), Palette::kMask),
                  b = read_mask_raw(dir.file("b.png"), Palette::kMask);
    CHECK(a.bits == 8);
    CHECK(b.bits == 16);
    CHECK(a.channels == channels);
    CHECK(std::equal(a.data.begin(), a.data.end(), small.data.begin(), small.data.end()));
    CHECK(b.data == large.data);
  }
}

TEST_CASE("read_image_rgb scales to [0, 1], replicates grey and composites transparent pixels over the background") {
  const TempDir dir;
  ImageU16 grey(1, 1, 1, 65535);
  write_png16(dir.file("grey.png"), grey);
  CHECK(read_image_rgb(dir.file("grey.png")).data == std::vector<float>{1, 1, 1});
  ImageU8 rgba(1, 1, 4);
  rgba.data = {255, 51, 0, 255};
  write_png(dir.file("opaque.png"), rgba);
  const ImageF opaque = read_image_rgb(dir.file("opaque.png"), {0, 1, 1});
  CHECK(opaque.channels == 3);
  CHECK(opaque.data[0] == 1.f);
  CHECK(opaque.data[1] == doctest::Approx(0.2));
  CHECK(opaque.data[2] == 0.f);
  rgba.data = {255, 51, 0, 51};
  write_png(dir.file("rgba.png"), rgba);
  const ImageF over = read_image_rgb(dir.file("rgba.png"), {0, 1, 0.5f});
  CHECK(over.data[0] == doctest::Approx(0.2));
  CHECK(over.data[1] == doctest::Approx(0.84));
  CHECK(over.data[2] == doctest::Approx(0.4));
  CHECK_FALSE(is_transparent(dir.file("grey.png")));
  CHECK_FALSE(is_transparent(dir.file("opaque.png")));
  CHECK(is_transparent(dir.file("rgba.png")));
}

TEST_CASE("transparency is detected in 8 and 16 bit, and never in a JPEG") {
  const TempDir dir;
  ImageU16 rgba(2, 1, 4, 65535);
  rgba.data[7] = 65534;
  write_png16(dir.file("a.png"), rgba);
  CHECK(is_transparent(dir.file("a.png")));
  const std::vector<std::uint8_t> jpeg = encode_jpeg(ImageU8(8, 8, 3, 200), 90);
  CHECK_FALSE(is_transparent(dir.write("a.jpg", {reinterpret_cast<const char*>(jpeg.data()), jpeg.size()})));
}

TEST_CASE("a photo whose alpha channel is its mask is loaded without it, 8 and 16 bit") {
  const TempDir dir;
  ImageU8 rgba(2, 1, 4);
  rgba.data = {255, 0, 255, 0, 0, 255, 0, 255};
  write_png(dir.file("8.png"), rgba);
  ImageU16 deep(2, 1, 4);
  std::ranges::transform(rgba.data, deep.data.begin(), [](std::uint8_t v) { return std::uint16_t(v * 257); });
  write_png16(dir.file("16.png"), deep);
  for (const char* name : {"8.png", "16.png"}) {
    CAPTURE(name);
    Scene scene;
    scene.views.push_back({Camera{"", 2, 1}, dir.file(name), ""});
    CHECK(load_photo(scene, 0).data == std::vector<float>{0, 0, 0, 0, 1, 0});
    CHECK(photo_is_transparent(scene, 0));
    scene.views[0].mask_path = dir.file(name);
    CHECK(load_photo(scene, 0).data == std::vector<float>{1, 0, 1, 0, 1, 0});
    CHECK_FALSE(photo_is_transparent(scene, 0));
    CHECK(load_alpha(scene.views[0]).data == std::vector<float>{0, 1});
  }
}

TEST_CASE("a palette PNG gives its indices, whatever the colours and the bit depth") {
  const TempDir dir;
  const std::string palette("\x00\x00\x00\xff\x00\x00\x00\xff\x00\x00\x00\xff", 12);
  dir.write("p8.png", raw_png(3, 1, 8, 3, std::string("\0\0\1\3", 4), palette));
  dir.write("p2.png", raw_png(3, 1, 2, 3, std::string{0, char(0b00011100)}, palette));
  for (const char* name : {"p8.png", "p2.png"}) {
    const RawMask mask = read_mask_raw(dir.file(name), Palette::kIndices);
    CHECK(mask.channels == 1);
    CHECK(mask.data == std::vector<std::uint16_t>{0, 1, 3});
  }
}

TEST_CASE("a palette PNG mask gives its greys in any palette order, or a tracker's indices") {
  const TempDir dir;
  const auto values = [&](const std::string& palette, Palette meaning) {
    dir.write("p.png", raw_png(3, 1, 8, 3, std::string("\0\0\1\1", 4), palette));
    const RawMask mask = read_mask_raw(dir.file("p.png"), meaning);
    return decisive_samples(mask.samples()).value;
  };
  using Values = std::vector<std::uint16_t>;
  const std::string white_first("\xff\xff\xff\0\0\0", 6), tracker("\0\0\0\x80\0\0", 6), red_first("\xff\0\0\0\0\0", 6);
  CHECK(values(white_first, Palette::kMask) == Values{255, 0, 0});
  CHECK(values(white_first, Palette::kIndices) == Values{0, 1, 1});
  CHECK(values(tracker, Palette::kMask) == Values{0, 1, 1});
  CHECK(values(tracker, Palette::kColours) == Values{0, 128, 128});
  CHECK(values(red_first, Palette::kMask) == Values{255, 0, 0});
}

TEST_CASE("image size is read from the header and equals the decoded size") {
  const TempDir dir;
  write_png(dir.file("a.png"), ImageU8(17, 5, 3));
  CHECK(read_image_size(dir.file("a.png")) == ImageSize{17, 5});
}

TEST_CASE("every prefix of a PNG is refused as bad input") {
  const TempDir dir;
  write_png(dir.file("a.png"), ImageU8(4, 3, 1, 9));
  const std::string bytes = test::read_bytes(dir.file("a.png"));
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    dir.write("cut.png", bytes.substr(0, n));
    CAPTURE(n);
    CHECK_THROWS_AS(read_image_rgb(dir.file("cut.png")), Error);
    CHECK_THROWS_AS(read_mask_raw(dir.file("cut.png"), Palette::kMask), Error);
  }
}

TEST_CASE("a header that declares an absurd size is rejected before decoding") {
  const TempDir dir;
  const std::string header{0x7f, 0, 0, 0, 0x7f, 0, 0, 0, 8, 0, 0, 0, 0};
  dir.write("huge.png",
            "\x89PNG\r\n\x1a\n" + crc_chunk("IHDR", header) + crc_chunk("IDAT", "x") + crc_chunk("IEND", ""));
  CHECK_THROWS_WITH_AS(read_image_rgb(dir.file("huge.png")), doctest::Contains("expected between 1 px"), Error);
}

TEST_CASE("a truncated JPEG is refused instead of padded with grey") {
  const TempDir dir;
  // SOI, SOF0 (8 bit, 16x16, 1 component), SOS, data, no EOI
  const std::string jpeg(
      "\xFF\xD8\xFF\xC0\x00\x0B\x08\x00\x10\x00\x10\x01\x01\x11\x00\xFF\xDA\x00\x08\x01\x01\x00\x00\x3F\x00"
      "\x12\x34",
      27);
  dir.write("cut.jpg", jpeg);
  CHECK_THROWS_WITH_AS(read_image_rgb(dir.file("cut.jpg")), doctest::Contains("JPEG ends before"), Error);
}

TEST_CASE("area reduction averages exactly and nearest enlargement repeats") {
  ImageF image(4, 2, 1);
  image.data = {0, 1, 2, 3, 4, 5, 6, 7};
  CHECK(resize_area(image, 2, 1).data == std::vector<float>{2.5f, 4.5f});
  ImageF two(2, 1, 1);
  two.data = {3, 8};
  CHECK(resize_nearest(two, 4, 2).data == std::vector<float>{3, 3, 8, 8, 3, 3, 8, 8});
}

namespace {

/// Three views with photos of 6 x 4 px, 72 bytes each in 8 bit.
struct Photos {
  test::TempDir dir;
  Scene scene;

  Photos() {
    for (int v = 0; v < 3; ++v) {
      scene.views.push_back({Camera{"", 6, 4}, dir.file(std::to_string(v) + ".png"), ""});
      ImageU8 image(6, 4, 3);
      for (std::size_t i = 0; i < image.data.size(); ++i) image.data[i] = std::uint8_t(60 * v + int(i) % 50);
      write_png(scene.views.back().image_path, image);
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
