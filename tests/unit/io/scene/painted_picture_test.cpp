#include "ngs/io/scene/painted_picture.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "ngs/core/error.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/scene/prompt_files.h"
#include "support/error_code.h"
#include "support/random.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

constexpr int kWidth = 40, kHeight = 30;
using Colour = std::array<std::uint8_t, 4>;

/// Leaves, petals and shade in all colours: a third of the pixels are green or red enough to look like marks.
ImageU8 garden() {
  ImageU8 photo(kWidth, kHeight, 4);
  test::Random random(7);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      for (int c = 0; c < 3; ++c) photo.at(x, y, c) = std::uint8_t(random.uniform(20, 230));
      photo.at(x, y, 3) = 255;
    }
  return photo;
}

void paint_row(ImageU8& picture, int y, Colour colour) {
  for (int x = 5; x < 25; ++x)
    for (int c = 0; c < 4; ++c) picture.at(x, y, c) = colour[std::size_t(c)];
}

struct Files {
  test::TempDir dir;
  std::string photo = dir.path() + "/photo.png", picture = dir.path() + "/picture.png";
  Files() { io::write_png(photo, garden()); }

  HandPrompt read(const ImageU8& image) const {
    io::write_png(picture, image);
    return io::read_painted_picture(picture, photo);
  }
  std::string refusal(const ImageU8& image) const {
    const Error e = test::refused([&] { read(image); }, ErrorCode::kBadInput, "", "paint with pure green");
    return e.what();
  }
};

std::ptrdiff_t count(const HandPrompt& prompt, PixelHint hint) {
  return std::count(prompt.painted.begin(), prompt.painted.end(), hint);
}

const Colour kGreen{0, 255, 0, 255}, kRed{255, 0, 0, 255};

}  // namespace

TEST_CASE("pixels that differ from the photo are paint; the photo's own green and red pixels are not") {
  const Files files;
  ImageU8 painted = garden();
  paint_row(painted, 10, kGreen);
  paint_row(painted, 20, kRed);
  const HandPrompt prompt = files.read(painted);
  CHECK(count(prompt, PixelHint::kObject) == 20);
  CHECK(count(prompt, PixelHint::kBackground) == 20);
  CHECK(prompt.painted[10 * kWidth + 5] == PixelHint::kObject);
  CHECK(prompt.painted[20 * kWidth + 24] == PixelHint::kBackground);

  for (std::uint8_t& sample : painted.data) sample = std::uint8_t(std::clamp(int(sample) + 9, 0, 255));  // compressed
  CHECK(count(files.read(painted), PixelHint::kObject) == 20);
}

TEST_CASE("a painted picture saved as JPEG has the marks of the PNG and no compression artefacts") {
  const int width = 160, height = 120;
  ImageU8 photo(width, height, 3);
  const auto set = [](ImageU8& image, int x, int y, std::array<int, 3> colour) {
    for (int c = 0; c < 3; ++c) image.at(x, y, c) = std::uint8_t(std::clamp(colour[std::size_t(c)], 0, 255));
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const bool in_ball = std::hypot(x - 80, y - 50) < 40;
      const int shade = (x + y) / 4;
      set(photo, x, y, in_ball ? std::array{150 + shade, 25 + shade / 3, 30} : std::array{120, 110 + shade / 4, 100});
    }
  ImageU8 painted = photo;
  const auto stroke = [&](int x0, int x1, int y0, std::array<int, 3> colour) {
    for (int y = y0; y < y0 + 7; ++y)
      for (int x = x0; x < x1; ++x) set(painted, x, y, colour);
  };
  stroke(60, 100, 46, {0, 255, 0});
  stroke(20, 140, 105, {255, 0, 0});
  const test::TempDir dir;
  io::write_png(dir.file("photo.png"), photo);
  io::write_png(dir.file("painted.png"), painted);
  const HandPrompt exact = io::read_painted_picture(dir.file("painted.png"), dir.file("photo.png"));
  for (const int quality : {60, 75, 90, 98}) {
    CAPTURE(quality);
    const std::vector<std::uint8_t> jpeg = io::encode_jpeg(painted, quality);
    dir.write("painted.jpg", {reinterpret_cast<const char*>(jpeg.data()), jpeg.size()});
    const HandPrompt prompt = io::read_painted_picture(dir.file("painted.jpg"), dir.file("photo.png"));
    std::array<int, 2> kept{}, made{};
    for (std::size_t p = 0; p < prompt.painted.size(); ++p)
      for (const int k : {0, 1}) {
        const PixelHint hint = k == 0 ? PixelHint::kObject : PixelHint::kBackground;
        if (prompt.painted[p] != hint) continue;
        ++(exact.painted[p] == hint ? kept : made)[std::size_t(k)];
      }
    CHECK(kept[0] > 0.7 * 40 * 7);
    CHECK(kept[1] > 0.7 * 120 * 7);
    CHECK(made[0] <= 4);  // at the edges of strokes
    CHECK(made[1] <= 4);
  }
}

TEST_CASE("a photo without paint, a different photo and paint of other colours are rejected with the shares found") {
  const Files files;
  CHECK(files.refusal(garden()).find("nothing is painted on the photo") != std::string::npos);
  ImageU8 turned = garden();
  std::reverse(turned.data.begin(), turned.data.end());
  for (std::size_t p = 3; p < turned.data.size(); p += 4) turned.data[p] = 255;
  CHECK(files.refusal(turned).find(" % is green, ") != std::string::npos);
  ImageU8 blue = garden();
  paint_row(blue, 10, {0, 0, 255, 255});
  CHECK(files.refusal(blue).find(" other colours") != std::string::npos);
}

TEST_CASE("markers alone are read on transparency, on grey and on one colour, at any size") {
  const Files files;
  for (const Colour ground :
       {Colour{0, 200, 0, 0}, Colour{0, 0, 0, 255}, Colour{255, 255, 255, 255}, Colour{40, 60, 120, 255}}) {
    CAPTURE(int(ground[0]));
    ImageU8 markers(2 * kWidth, 2 * kHeight, 4);
    for (std::size_t i = 0; i < markers.data.size(); ++i) markers.data[i] = ground[i % 4];
    paint_row(markers, 10, kGreen);
    paint_row(markers, 20, kRed);
    for (int x = 5; x < 25; ++x) {  // a soft edge
      markers.at(x, 11, 1) = 100;
      markers.at(x, 11, 0) = 20;
    }
    const HandPrompt prompt = files.read(markers);
    CHECK(prompt.width_px == 2 * kWidth);
    CHECK(count(prompt, PixelHint::kObject) == 20);
    CHECK(count(prompt, PixelHint::kBackground) == 20);
  }
}

TEST_CASE("a painted photo of twice the size is read; the photo's own green pixels are not paint") {
  const Files files;
  ImageU8 large(2 * kWidth, 2 * kHeight, 4);
  const ImageU8 small = garden();
  for (int y = 0; y < large.height_px; ++y)
    for (int x = 0; x < large.width_px; ++x)
      for (int c = 0; c < 4; ++c) large.at(x, y, c) = small.at(x / 2, y / 2, c);
  paint_row(large, 10, kGreen);
  CHECK(count(files.read(large), PixelHint::kObject) == 20);
}

TEST_CASE("a photo is rejected as a one-sided scribble; a mask is accepted, compressed or not") {
  const Files files;
  HandPrompt prompt;
  test::refused([&] { io::add_scribbles(files.photo, true, prompt); }, ErrorCode::kBadInput,
                "100 % of the picture is not black and has many colours");
  ImageU8 mask(kWidth, kHeight, 1, 250);
  for (std::size_t p = 0; p < mask.data.size(); p += 3) mask.data[p] = 255;
  mask.data[0] = 0;
  io::write_png(files.picture, mask);
  io::add_scribbles(files.picture, true, prompt);
  CHECK(count(prompt, PixelHint::kObject) == kWidth * kHeight - 1);
}

namespace {

/// `picture` with every pixel as a square of `factor`, or the mean of such squares for a negative factor.
ImageU8 resized(const ImageU8& picture, int factor) {
  const int k = std::abs(factor), w = factor > 0 ? k * picture.width_px : picture.width_px / k,
            h = factor > 0 ? k * picture.height_px : picture.height_px / k;
  ImageU8 out(w, h, picture.channels);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      for (int c = 0; c < picture.channels; ++c) {
        int sum = 0;
        for (int j = 0; j < k * k && factor < 0; ++j) sum += picture.at(k * x + j % k, k * y + j / k, c);
        out.at(x, y, c) = factor > 0 ? picture.at(x / k, y / k, c) : std::uint8_t(sum / (k * k));
      }
  return out;
}

}  // namespace

TEST_CASE("paint on the photo at another size is read, on another shape it is an error with both sizes") {
  test::TempDir dir;
  const std::string photo = dir.path() + "/photo.png", picture = dir.path() + "/picture.png";
  const ImageU8 garden4 = resized(garden(), 4);  // 160 x 120
  io::write_png(photo, garden4);
  ImageU8 painted = garden4;
  for (int y = 40; y < 48; ++y) {
    paint_row(painted, y, kGreen);
    paint_row(painted, y + 40, kRed);
  }
  for (const int factor : {2, -2}) {
    CAPTURE(factor);
    io::write_png(picture, resized(painted, factor));
    const HandPrompt prompt = io::read_painted_picture(picture, photo);
    const int pixels = factor > 0 ? 8 * 20 * 4 : 8 * 20 / 4;
    CHECK(prompt.width_px == (factor > 0 ? 320 : 80));
    for (const PixelHint hint :
         {PixelHint::kObject, PixelHint::kBackground}) {  // few cells of the photo have its colour
      CHECK(double(count(prompt, hint)) > 0.6 * pixels);
      CHECK(double(count(prompt, hint)) <= pixels);
    }
  }
  io::write_png(picture, resized(garden4, 2));  // nothing is painted
  CHECK_THROWS_AS(io::read_painted_picture(picture, photo), Error);
  ImageU8 cropped(100, 120, 4);
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 100; ++x)
      for (int c = 0; c < 4; ++c) cropped.at(x, y, c) = painted.at(x, y, c);
  io::write_png(picture, cropped);
  const Error e = test::thrown_by([&] { io::read_painted_picture(picture, photo); });
  CHECK(std::string(e.what()).find("100x120 px, expected a marked copy of ") != std::string::npos);
}

}  // namespace ngs
