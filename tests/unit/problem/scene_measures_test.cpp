// Tests each measure on a case in which the naive measure that it replaces decides wrongly.
#include "ngs/problem/scene_measures.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "ngs/ops/neighbours/knn.h"
#include "support/cameras.h"
#include "support/splat_shapes.h"

namespace ngs {
namespace {

Camera front_camera() { return test::camera_along_z(64, 48, 60); }

/// A row of `n` opaque Gaussians of scale e^log_scale, 4 units in front of the camera.
GaussianCloud row_of(int n, float log_scale, int degree = 1) {
  GaussianCloud cloud;
  cloud.sh_degree = degree;
  for (int i = 0; i < n; ++i) test::add_gaussian(cloud, {0.1 * (i - n / 2), 0, 4}, std::exp(log_scale), {}, 4);
  return cloud;
}

KnnGraph chain(const std::vector<float>& position) {
  return nearest_others({}, {position.data(), std::int64_t(position.size() / 3)}, 2);
}

std::vector<float> along_x(int n) {
  std::vector<float> position;
  for (int i = 0; i < n; ++i) position.insert(position.end(), {float(i), 0, 0});
  return position;
}

}  // namespace

TEST_CASE("straddling: Gaussians outside the image that reach into it count, also with fy > fx") {
  Camera camera = front_camera();
  camera.fy = 4 * camera.fx;
  GaussianCloud cloud = row_of(1, std::log(0.3f));
  cloud.position[1] = -0.9f;  // 30 px above the image; three deviations are 54 px
  CHECK(straddling_bound_px(cloud, std::vector<Camera>{camera}, {}) > 0);
  cloud.position[1] = -2;
  CHECK(straddling_bound_px(cloud, std::vector<Camera>{camera}, {}) == 0);
}

TEST_CASE("view dependence: a large coefficient that is not visible does not count, a sum of many small ones does") {
  const std::vector<Camera> cameras{front_camera()};
  GaussianCloud hidden = row_of(3, -2);
  hidden.sh_rest[3] = 2;  // band z of the first Gaussian, which is nearly transparent
  hidden.logit_opacity[0] = -12;
  CHECK(view_dependence_levels(hidden, cameras) < 0.5);
  hidden.logit_opacity[0] = 4;
  hidden.position[2] = -4;  // behind the camera
  CHECK(view_dependence_levels(hidden, cameras) < 0.5);
  GaussianCloud many = row_of(3, -2, 3);
  for (float& c : many.sh_rest) c = 0.0019f;  // each alone below half a level: 255 * 0.0019 = 0.48
  CHECK(view_dependence_levels(many, cameras) > 0.5);
  CHECK(view_dependence_levels(row_of(3, -2, 0), cameras) == 0);
}

TEST_CASE("compensation: 0 for large footprints although the flag is set") {
  const std::vector<Camera> cameras{front_camera()};
  GaussianCloud small = row_of(3, -4.f);
  const GaussianCloud large = row_of(3, 1.f);
  const SplatOptions with{.antialiased = true};
  CHECK(antialias_levels(large, cameras, with) < 0.5);
  CHECK(antialias_levels(small, cameras, with) > 100);
  small.antialiased = true;  // --antialias off overrides the flag of the model
  CHECK(antialias_levels(small, cameras, {}) == 0);
}

TEST_CASE("straddling: tiny Gaussians on the contour stay below 3 px, a large one exceeds 100 px") {
  const std::vector<Camera> cameras{front_camera()};
  GaussianCloud specks = row_of(3, -8);
  for (float& o : specks.logit_opacity) o = -1;
  CHECK(straddling_bound_px(specks, cameras, {}) < 3);  // whatever their share of object evidence
  CHECK(straddling_bound_px(row_of(1, 0), cameras, {}) > 100);
  CHECK(straddling_bound_px({}, cameras, {}) == 0);
}

TEST_CASE("straddling: the bound of a Gaussian larger than the image is at most half of the image per view") {
  GaussianCloud cloud = row_of(1, 3);  // larger than the image
  const std::vector<Camera> cameras{front_camera(), front_camera()};
  CHECK(straddling_bound_px(cloud, cameras, {}) <= 2 * 0.5 * 64 * 48);
}

TEST_CASE("neighbours: a seam between two plain halves hardly changes the RMS difference, but gives the largest one") {
  const int n = 400;
  const KnnGraph graph = chain(along_x(n));
  std::vector<float> halves(std::size_t(n) * 3, 0.f);
  for (std::size_t i = halves.size() / 2; i < halves.size(); ++i) halves[i] = 0.02f;
  const Rows<const float, 3> colour{halves.data(), n};
  CHECK(colour_range_levels(colour) > 5);            // the naive measure for L_cont: on
  CHECK(neighbour_rms_levels(graph, colour) < 0.5);  // the few edges across the seam vanish in the mean: off
  CHECK(neighbour_max_levels(graph, colour) > 5);    // nearest and interpolated feature differ at the seam: on
}

TEST_CASE("range: a ramp has a large range although neighbours hardly differ") {
  const int n = 400;
  std::vector<float> ramp;
  for (int i = 0; i < n; ++i) ramp.insert(ramp.end(), {float(i) / n, 0.5f, 0.5f});
  const Rows<const float, 3> colour{ramp.data(), n};
  CHECK(neighbour_rms_levels(chain(along_x(n)), colour) < 1);
  CHECK(colour_range_levels(colour) > 200);
  CHECK(colour_range_levels({nullptr, 0}) == 0);
  CHECK(neighbour_rms_levels({}, {nullptr, 0}) == 0);
}

TEST_CASE("patches: texture away from the contour does not count") {
  const int w = 40, h = 30;
  ImageF photo(w, h, 3, 0.5f);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < 12; ++x) photo.at(x, y, 0) = float((x + y) % 2);
  std::vector<std::uint8_t> mask(std::size_t(w * h), 0);
  for (int y = 10; y < 20; ++y)
    for (int x = 25; x < 33; ++x) mask[std::size_t(y * w + x)] = 1;
  CHECK(contour_deviation_levels(photo, {mask.data(), w, h}) == 0);
  for (int y = 0; y < h; ++y)
    for (int x = 29; x < w; ++x) photo.at(x, y, 1) = 0.7f;
  CHECK(contour_deviation_levels(photo, {mask.data(), w, h}) > 1);
  std::fill(mask.begin(), mask.end(), std::uint8_t(0));
  CHECK(contour_deviation_levels(photo, {mask.data(), w, h}) == 0);
}

TEST_CASE("cells: the spacing of clustered points is smaller than count and extent suggest") {
  // 1000 points within a hundredth of a box of side 10, and one at its far corner.
  std::vector<float> nearest(1000, 0.01f);
  nearest.push_back(10.f);
  const double naive_spacing = 10 / std::cbrt(1001.0);
  CHECK(10.0 / 512 / naive_spacing < 0.5);           // naive: 512 cells are too fine
  CHECK(cells_per_spacing(nearest, 10, 512) > 0.5);  // the true spacing supports them
  CHECK(cells_per_spacing({}, 10, 512) == 0);
  CHECK(std::isinf(cells_per_spacing({0.f, 0.f}, 10, 512)));
}

TEST_CASE("gain: one view with a large gain is not significant") {
  CHECK(gain_in_standard_errors({0.3, -0.01, 0, -0.02, 0.01, 0}) < 2);     // naive: mean gain 0.047
  CHECK(gain_in_standard_errors({0.01, 0.012, 0.008, 0.011, 0.009}) > 2);  // naive: only 0.01
  CHECK(gain_in_standard_errors({}) == 0);
  CHECK(gain_in_standard_errors({0, 0, 0}) == 0);
  CHECK(gain_in_standard_errors({0.1, 0.1}) == INFINITY);
  CHECK(gain_in_standard_errors({-0.1, -0.1}) == -INFINITY);
}

TEST_CASE("outside: the share of weight counts, not the share of pixels") {
  ImageF label(100, 100, 1, 0.f);
  for (int y = 45; y < 55; ++y)
    for (int x = 45; x < 55; ++x) label.at(x, y) = 1;
  CHECK(weight_outside(label, 40, 40, 60, 60) == 0);  // 96 % of the pixels lie outside
  label.at(2, 2) = 1;
  CHECK(weight_outside(label, 40, 40, 60, 60) == doctest::Approx(1.0 / 101));
  CHECK(weight_outside(ImageF(3, 3, 1), 0, 0, 1, 1) == 0);
}

TEST_CASE("narrow parts: a small solid mask has none, a large mask of stripes has many") {
  const int w = 120, h = 90;
  const auto drawn = [&](const auto& inside) {
    std::vector<std::uint8_t> mask(std::size_t(w * h));
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) mask[std::size_t(y * w + x)] = inside(x, y);
    return mask;
  };
  const auto share = [&](const std::vector<std::uint8_t>& mask) {
    const NarrowParts parts = narrow_parts({mask.data(), w, h});
    return parts.narrow_px2 / parts.all_px2;
  };
  const auto contour_by_area = [&](const std::vector<std::uint8_t>& mask) {
    const std::vector<std::int32_t> depth = chessboard_distance({mask.data(), w, h}, Outside::kUnknown);
    return double(std::count(depth.begin(), depth.end(), 1)) / double(std::count(mask.begin(), mask.end(), 1));
  };
  const auto box = drawn([](int x, int y) { return x >= 50 && x < 59 && y >= 40 && y < 49; });
  // Six stripes of 8 px next to a solid quarter.
  const auto stripes =
      drawn([](int x, int y) { return x >= 10 && x < 106 && y >= 20 && y < 60 && (x >= 82 || x % 12 < 8); });
  CHECK(share(box) == 0);
  CHECK(share(stripes) > 0.5);
  CHECK(contour_by_area(stripes) < contour_by_area(box));  // naive: the box would be thinner
  const auto whisker = drawn([](int x, int y) { return (x < 60 && y < 60) || (y == 30 && x < 80); });
  CHECK(share(whisker) == doctest::Approx(20.0 / 3620));  // the mask continues outside the image
  const auto cut = drawn([](int x, int) { return x < 5; });
  CHECK(share(cut) == 0);
  const NarrowParts none = narrow_parts({std::vector<std::uint8_t>(16).data(), 4, 4});
  CHECK((none.all_px2 == 0 && none.narrow_px2 == 0));
}

TEST_CASE("normal_score: few views never reach significance, and the score is continuous in their number") {
  CHECK(normal_score(-INFINITY, 1) == 0);
  CHECK(normal_score(-INFINITY, 3) > -kSignificant);  // three views never suffice
  CHECK(normal_score(-INFINITY, 12) < -kSignificant);
  CHECK(normal_score(-INFINITY, 3) == doctest::Approx(normal_score(-1e9, 3)));
  // The quantiles of Student's t for 2 standard errors (0.02275): 2.255 of 11 degrees of freedom, 2.079 of 31, 2.025
  // of 99.
  const std::pair<std::size_t, double> quantiles[] = {{12, 2.255}, {32, 2.079}, {100, 2.025}};
  for (const auto& [views, t] : quantiles)
    CHECK(normal_score(t * std::sqrt(double(views) / double(views - 1)), views) == doctest::Approx(2).epsilon(0.005));
  for (std::size_t views = 3; views < 101; ++views) {
    CAPTURE(views);
    const double step = normal_score(4, views + 1) - normal_score(4, views);
    CHECK(step > 0);
    CHECK(step < 0.4);
  }
  CHECK(normal_score(4, 32) - normal_score(4, 31) < 0.02);
}

}  // namespace ngs
