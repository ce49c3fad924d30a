#include "ngs/ops/image/contour_refine.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "ngs/core/rng.h"

namespace ngs {
namespace {

constexpr int kPhotoWidth_px = 72, kPhotoHeight_px = 60;

/// A photo of two colours that meet at x = `edge`, with noise.
ImageF two_colours(double edge, double contrast, double noise) {
  ImageF photo(kPhotoWidth_px, kPhotoHeight_px, 3);
  for (int y = 0; y < kPhotoHeight_px; ++y)
    for (int x = 0; x < kPhotoWidth_px; ++x)
      for (int c = 0; c < 3; ++c) {
        const auto i = std::uint64_t(photo.index(x, y, c));
        photo.at(x, y, c) =
            float(0.4 + (x < edge ? contrast : 0.0) * (c == 0 ? 1 : 0.3) + noise * rng_normal(5, RngStream::kTest, i));
      }
  return photo;
}

std::vector<std::uint8_t> left_of(double edge) {
  std::vector<std::uint8_t> mask;
  for (int y = 0; y < kPhotoHeight_px; ++y)
    for (int x = 0; x < kPhotoWidth_px; ++x) mask.push_back(x < edge);
  return mask;
}

/// Mean x of the contour: the object's pixels per row.
double contour(const std::vector<float>& soft) {
  return double(std::count_if(soft.begin(), soft.end(), [](float x) { return x > 0.5f; })) / kPhotoHeight_px;
}

std::vector<float> refine(const std::vector<std::uint8_t>& mask, const ImageF& photo,
                          ContourRefineOptions options = {}) {
  return refine_contour(options, {mask.data(), kPhotoWidth_px, kPhotoHeight_px}, photo);
}

TEST_CASE("refine_contour moves a contour to the photo's edge from either side, and not beyond the band") {
  const ImageF photo = two_colours(36, 0.3, 0.02);
  for (const double start : {32., 34., 36., 38., 40.}) {
    CAPTURE(start);
    CHECK(contour(refine(left_of(start), photo)) == doctest::Approx(36).epsilon(0.002));
  }
  // 12 px away: pixels outside the band keep their side.
  CHECK(contour(refine(left_of(24), photo)) < 24 + 5.01);
}

// Stripes are edges in one direction only: the edge threshold must not depend on the direction.
TEST_CASE("refine_contour of a transposed image gives the transposed contour") {
  constexpr int kSide = 160;
  ImageF photo(kSide, kSide, 3), turned = photo;
  std::vector<std::uint8_t> mask(kSide * kSide), turned_mask = mask;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const double r = std::hypot(x - 79.5, y - 79.5);
      mask[std::size_t(y * kSide + x)] = turned_mask[std::size_t(x * kSide + y)] = r < 37;
      for (int c = 0; c < 3; ++c)
        photo.at(x, y, c) = turned.at(y, x, c) =
            float(0.4 + (r < 40 ? 0.12 : 0) + 0.06 * std::sin(0.9 * y) +
                  0.004 * rng_normal(7, RngStream::kTest, std::uint64_t(photo.index(x, y, c))));
    }
  const std::vector<float> soft = refine_contour({}, {mask.data(), kSide, kSide}, photo),
                           soft_turned = refine_contour({}, {turned_mask.data(), kSide, kSide}, turned);
  int different = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      different += (soft[std::size_t(y * kSide + x)] > 0.5f) != (soft_turned[std::size_t(x * kSide + y)] > 0.5f);
  CHECK(different <= 1);  // with steps along x alone: 76 pixels
}

TEST_CASE("refine_contour keeps the contour without an edge in the photo") {
  for (const double start : {20., 36., 51.})
    CHECK(contour(refine(left_of(start), two_colours(36, 0, 0))) == doctest::Approx(start));
  // Noise alone moves the contour by less than a pixel.
  CHECK(contour(refine(left_of(30), two_colours(36, 0, 0.02))) == doctest::Approx(30).epsilon(0.02));
}

TEST_CASE("refine_contour follows colours where the strongest edge is not the object's") {
  // A dark line next to the true contour. Edges alone attract the contour to the line, but both sides of it have the
  // colour of the object.
  ImageF photo = two_colours(36, 0.3, 0.01);
  for (int y = 0; y < kPhotoHeight_px; ++y)
    for (int c = 0; c < 3; ++c) photo.at(33, y, c) = 0.05f;
  CHECK(contour(refine(left_of(35), photo)) == doctest::Approx(36).epsilon(0.03));
  CHECK(contour(refine(left_of(32), photo, {.colour_weight = 0})) < 34.5);
}

TEST_CASE("refine_contour is not attracted by edges of a texture on both sides") {
  ImageF photo(kPhotoWidth_px, kPhotoHeight_px, 3);
  for (int y = 0; y < kPhotoHeight_px; ++y)
    for (int x = 0; x < kPhotoWidth_px; ++x)
      for (int c = 0; c < 3; ++c) photo.at(x, y, c) = x / 7 % 2 == 0 ? 0.3f : 0.6f;
  ContourRefineOptions naive;  // colours have full weight, however ambiguous
  naive.ambiguity_weight = 0;
  for (const double start : {37., 38., 39.}) {  // the stripe goes from 35 to 42
    CAPTURE(start);
    CHECK(contour(refine(left_of(start), photo)) == doctest::Approx(start));
    CHECK(std::abs(contour(refine(left_of(start), photo, naive)) - start) >= 1);
  }
}

TEST_CASE("refine_contour returns masks without a contour unchanged, and values in [0, 1]") {
  const ImageF photo = two_colours(36, 0.3, 0.3);
  for (const double start : {0., double(kPhotoWidth_px)}) {
    const std::vector<std::uint8_t> mask = left_of(start);
    const std::vector<float> soft = refine(mask, photo);
    CHECK(std::equal(soft.begin(), soft.end(), mask.begin(), [](float a, std::uint8_t b) { return a == float(b); }));
  }
  std::vector<std::uint8_t> speck(std::size_t(kPhotoWidth_px) * kPhotoHeight_px, 0);
  speck[std::size_t(kPhotoWidth_px) * 30 + 36] = 1;
  for (const auto& mask : {speck, left_of(1), left_of(36)})
    for (const float x : refine(mask, photo)) REQUIRE((x >= 0.f && x <= 1.f));
}

}  // namespace
}  // namespace ngs
