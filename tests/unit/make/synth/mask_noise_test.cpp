#include "ngs/make/synth/mask_noise.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "ngs/core/error.h"
#include "ngs/make/synth/contour_snap.h"

namespace ngs::synth {
namespace {

MaskNoise noise_of(const std::string& spec) {
  const std::vector<std::string> specs{spec};
  return parse_mask_noise(specs);
}

ImageU16 disc_image(int size, double radius, std::uint16_t id = 1) {
  ImageU16 image(size, size, 1);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      if (std::hypot(x + 0.5 - size / 2.0, y + 0.5 - size / 2.0) < radius) image.at(x, y) = id;
  return image;
}

double area(const ImageU16& image, std::uint16_t id = 1) {
  double count = 0;
  for (const std::uint16_t v : image.data) count += v == id;
  return count;
}

}  // namespace

TEST_CASE("parse_mask_noise parses lists and fails for unknown kinds") {
  const MaskNoise noise = noise_of("erode:1.5,drop:0.25");
  CHECK(noise.erode_px == 1.5);
  CHECK(noise.drop == 0.25);
  CHECK(noise.any());
  CHECK_FALSE(MaskNoise{}.any());
  for (const char* bad : {"", "erode", "erode:", "erode:x", "erode:1x", "erode:-1", "erode:nan", "drop:1.1", "smear:1",
                          "erode:1,", "jitter:1e9"}) {
    CAPTURE(bad);
    CHECK_THROWS_AS(noise_of(bad), Error);
  }
}

TEST_CASE("masks of one object have no ids to swap") {
  const std::vector<std::string> swap = {"swap:1"}, unknown = {"smear:1"};
  CHECK(parse_mask_noise(swap).swap == 1);
  CHECK_THROWS_WITH_AS(parse_mask_noise(swap, NoiseOf::kOneObject), doctest::Contains("\"swap:1\", expected erode:PX"),
                       Error);
  CHECK_THROWS_WITH_AS(parse_mask_noise(unknown), doctest::Contains("swap:P or blob:P"), Error);
  CHECK_THROWS_WITH_AS(parse_mask_noise(unknown, NoiseOf::kOneObject), doctest::Contains("drop:P, or blob:P"), Error);
}

TEST_CASE("masks of everything without errors have the exact contours, and ids in another order in every view") {
  ImageU16 exact(40, 30, 1);
  for (int y = 5; y < 25; ++y)
    for (int x = 0; x < 40; ++x) exact.at(x, y) = std::uint16_t(x / 4 == 3 ? 0 : 300 + x / 4);
  std::set<std::vector<std::uint16_t>> orders;
  for (int view = 0; view < 8; ++view) {
    const ImageU16 masks = masks_of_everything({}, exact, {}, {0, view, 5});
    std::map<std::uint16_t, std::uint16_t> name;
    for (std::size_t i = 0; i < exact.data.size(); ++i)
      CHECK(name.emplace(exact.data[i], masks.data[i]).first->second == masks.data[i]);
    CHECK(name.at(0) == 0);
    std::vector<std::uint16_t> order;
    for (const auto& [id, given] : name) order.push_back(given);
    orders.insert(order);
    std::sort(order.begin(), order.end());
    for (std::size_t k = 0; k < order.size(); ++k) CHECK(order[k] == k);
  }
  CHECK(orders.size() == 8);
}

TEST_CASE("masks of everything merge neighbours and split masks in the stated share of the cases") {
  ImageU16 exact(60, 20, 1);  // pairs of neighbours, 10 px each, with 10 px between the pairs
  for (int y = 5; y < 15; ++y)
    for (int x = 0; x < 60; ++x) exact.at(x, y) = std::uint16_t(x % 30 < 20 ? 1 + x / 10 : 0);
  const auto count = [&](const MaskNoise& noise, int view) {
    const ImageU16 masks = masks_of_everything({}, exact, noise, {0, view, 9});
    for (std::size_t i = 0; i < masks.data.size(); ++i) CHECK((masks.data[i] == 0) == (exact.data[i] == 0));
    return int(*std::max_element(masks.data.begin(), masks.data.end()));
  };
  CHECK(count({.merge = 1}, 0) == 2);
  CHECK(count({.split = 1}, 0) == 8);
  int split = 0, merged = 0;
  for (int view = 0; view < 200; ++view) {
    split += count({.split = 0.25}, view) - 4;
    merged += 4 - count({.merge = 0.1}, view);
  }
  CHECK(std::abs(split - 200) < 40);          // 800 draws at .25: 12 is one standard deviation
  CHECK(std::abs(merged - 400 * 0.19) < 30);  // a pair merges if one of two draws selects it
  const ImageU16 surfaces = [&] {
    ImageU16 image = exact;
    for (std::size_t p = 0; p < image.data.size(); ++p)
      if (exact.data[p] == 0) image.data[p] = std::uint16_t(p % 60 < 30 ? 70 : 71);
    return image;
  }();
  const ImageU16 all = masks_of_everything({}, exact, {.background = 1}, {0, 0, 9, nullptr, &surfaces});
  CHECK(std::set<std::uint16_t>(all.data.begin(), all.data.end()) == std::set<std::uint16_t>{1, 2, 3, 4, 5, 6});
  const std::vector<std::string> parts = {"split:0.5,merge:1"};
  CHECK(parse_mask_noise(parts, NoiseOf::kEverything).split == 0.5);
  CHECK_THROWS_WITH_AS(parse_mask_noise(parts), doctest::Contains("\"split:0.5\", expected erode:PX"), Error);
}

TEST_CASE("no noise returns the exact labels") {
  const ImageU16 exact = disc_image(32, 9);
  CHECK(disturb_labels({}, exact, {}, {0, 3, 7}).data == exact.data);
}

TEST_CASE("dilating and eroding a disc changes its radius by the given amount") {
  // A lattice disc's area deviates from πr² by the pixels that its contour cuts: below 0.5 px of radius here.
  const double pi = 3.141592653589793, r = 30;
  const ImageU16 exact = disc_image(100, r);
  for (const double px : {1.0, 2.0, 5.0}) {
    const double grown = std::sqrt(area(disturb_labels({}, exact, {.dilate_px = px}, {0, 0, 1})) / pi) - r;
    const double shrunk = r - std::sqrt(area(disturb_labels({}, exact, {.erode_px = px}, {0, 0, 1})) / pi);
    CHECK(std::abs(grown - px) < 0.5);
    CHECK(std::abs(shrunk - px) < 0.5);
  }
}

TEST_CASE("jitter moves the contour with the stated standard deviation and keeps the mean area") {
  const ImageU16 exact = [] {  // a half plane: every row is one sample of the contour's displacement
    ImageU16 image(120, 400, 1);
    for (int y = 0; y < 400; ++y)
      for (int x = 0; x < 60; ++x) image.at(x, y) = 1;
    return image;
  }();
  for (const double sigma : {1.5, 4.0}) {
    double sum = 0, squares = 0;
    const int views = 40;
    for (int view = 0; view < views; ++view) {
      const ImageU16 moved = disturb_labels({.threads = 2}, exact, {.jitter_px = sigma}, {0, view, 5});
      for (int y = 0; y < 400; ++y) {
        double covered = 0;
        for (int x = 0; x < 120; ++x) covered += moved.at(x, y);
        sum += covered - 60;
        squares += (covered - 60) * (covered - 60);
      }
    }
    // Neighbouring rows are alike: 40 views x 400 px / (8 + 4σ) px are 470 to 1140 independent samples.
    const double n = views * 400.0, mean = sum / n, deviation = std::sqrt(squares / n - mean * mean);
    CHECK(std::abs(mean) < 4 * sigma / std::sqrt(470.0));
    CHECK(deviation == doctest::Approx(sigma).epsilon(0.15));
  }
}

TEST_CASE("drop and swap occur with their probability, per view and object") {
  ImageU16 exact(8, 2, 1);
  for (int x = 0; x < 8; ++x) exact.at(x, 0) = std::uint16_t(x < 4 ? 1 : 2);
  int dropped = 0, swapped = 0;
  const int views = 2000;
  for (int view = 0; view < views; ++view) {
    dropped += disturb_labels({}, exact, {.drop = 0.2}, {0, view, 1}).at(0, 0) == 0;
    swapped += disturb_labels({}, exact, {.swap = 0.2}, {0, view, 1}).at(0, 0) == 2;
  }
  const double spread = 4 * std::sqrt(views * 0.25);  // four standard deviations of the widest binomial
  CHECK(std::abs(dropped - 0.2 * views) < spread);
  // Two objects: exchanged if exactly one of the two draws is a swap, 2·0.2·0.8.
  CHECK(std::abs(swapped - 0.32 * views) < spread);
}

TEST_CASE("blobs change a contour region of the object they hit and nothing else") {
  const ImageU16 exact = disc_image(64, 15, 3);
  int added = 0, removed = 0, untouched = 0;
  for (int view = 0; view < 200; ++view) {
    const double change = area(disturb_labels({}, exact, {.blob = 0.5}, {0, view, 2}), 3) - area(exact, 3);
    (change > 0 ? added : change < 0 ? removed : untouched)++;
    CHECK(std::abs(change) <= 3.2 * 0.45 * 0.45 * 15 * 15);
  }
  CHECK(std::abs(untouched - 100) < 30);
  CHECK(added > 20);
  CHECK(removed > 20);
}

TEST_CASE("a separately made mask grows over its neighbour, a label map does not") {
  ImageU16 exact(10, 1, 1);
  for (int x = 0; x < 10; ++x) exact.at(x, 0) = std::uint16_t(x < 5 ? 1 : 2);
  CHECK(area(disturb_labels({}, exact, {.dilate_px = 2}, {1, 0, 1})) == 7);
  CHECK(disturb_labels({}, exact, {.dilate_px = 2}, {0, 0, 1}).data == exact.data);
}

TEST_CASE("mask noise depends on seed and view, and not on the thread count") {
  const ImageU16 exact = disc_image(80, 25);
  const MaskNoise noise = noise_of("jitter:2,blob:1,erode:1");
  const ImageU16 a = disturb_labels({.threads = 1}, exact, noise, {0, 4, 9});
  CHECK(a.data == disturb_labels({.threads = 3}, exact, noise, {0, 4, 9}).data);
  CHECK(a.data != disturb_labels({}, exact, noise, {0, 5, 9}).data);
  CHECK(a.data != disturb_labels({}, exact, noise, {0, 4, 10}).data);
}

TEST_CASE("mask_assignment leaves out and exchanges exactly the given fractions, by seed only") {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const std::vector<int> assigned = mask_assignment(20, 0.2, 0.1, seed);
    int missing = 0, wrong = 0;
    for (int v = 0; v < 20; ++v) {
      const int f = assigned[std::size_t(v)];
      CHECK(f >= -1);
      CHECK(f < 20);
      missing += f < 0;
      wrong += f >= 0 && f != v;
    }
    CHECK(missing == 4);
    CHECK(wrong == 2);
    CHECK(assigned == mask_assignment(20, 0.2, 0.1, seed));
  }
  CHECK(mask_assignment(20, 0.2, 0.1, 0) != mask_assignment(20, 0.2, 0.1, 1));
  CHECK(mask_assignment(0, 1, 1, 0).empty());
  CHECK(mask_assignment(1, 0, 1, 0) == std::vector<int>{-1});  // there is no other view's mask
  CHECK(mask_assignment(3, 0, 0, 5) == std::vector<int>{0, 1, 2});
  CHECK(mask_assignment(3, 1, 1, 5) == std::vector<int>{-1, -1, -1});
}

namespace {

constexpr int kSize = 64;

double radius_at(int x, int y) { return std::hypot(x + 0.5 - kSize / 2.0, y + 0.5 - kSize / 2.0); }

/// Labels of a disc of radius 16.
ImageU16 disc() {
  ImageU16 labels(kSize, kSize, 1);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) labels.at(x, y) = radius_at(x, y) < 16 ? 1 : 0;
  return labels;
}

/// A photo with an edge of `own` at radius 16, where the disc ends, and one of `wrong` at `wrong_radius`.
ImageF photo(float own, float wrong, double wrong_radius) {
  ImageF photo(kSize, kSize, 3);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x)
      for (int c = 0; c < 3; ++c)
        photo.at(x, y, c) = (radius_at(x, y) < 16 ? own : 0.f) + (radius_at(x, y) < wrong_radius ? wrong : 0.f);
  return photo;
}

/// Radius of a disc of the labels' area.
double radius_of(const ImageU16& labels) {
  double area = 0;
  for (const std::uint16_t id : labels.data) area += id;
  return std::sqrt(area / 3.141592653589793);
}

}  // namespace

TEST_CASE("a contour moves to a stronger edge within reach, on either side") {
  CHECK(radius_of(snap_contours({}, disc(), photo(0.1f, 0.4f, 19), 4)) > 18);
  CHECK(radius_of(snap_contours({}, disc(), photo(0.1f, 0.4f, 13), 4)) < 14);
}

TEST_CASE("a contour stays without a wrong edge, where the wrong edge is weak, and where it is out of reach") {
  const ImageU16 exact = disc();
  CHECK(snap_contours({}, exact, photo(0.2f, 0, 19), 4).data == exact.data);
  // A diagonal step's central differences are sqrt 2 times an upright one's: 0.6 is below 1 / sqrt 2.
  CHECK(snap_contours({}, exact, photo(0.4f, 0.4f * kSnapRatio * 0.6f, 19), 4).data == exact.data);
  CHECK(snap_contours({}, exact, photo(0.1f, 0.4f, 26), 4).data == exact.data);
  CHECK(snap_contours({}, ImageU16(kSize, kSize, 1), photo(0.1f, 0.4f, 19), 4).data == ImageU16(kSize, kSize, 1).data);
}

TEST_CASE("non-finite colours attract no contour, and the thread count does not change the result") {
  ImageF broken = photo(0.1f, 0.4f, 19);
  for (float& v : broken.data)
    if (v == 0.f) v = NAN;
  const ImageU16 exact = disc();
  CHECK(snap_contours({}, exact, broken, 4).data == exact.data);
  const ImageF fine = photo(0.1f, 0.4f, 19);
  CHECK(snap_contours({.threads = 1}, exact, fine, 4).data == snap_contours({.threads = 3}, exact, fine, 4).data);
}

}  // namespace ngs::synth
