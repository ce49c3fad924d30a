#include "ngs/ops/splat/evidence.h"

#include <doctest/doctest.h>

#include <cmath>

#include "ngs/cut/evidence/variance_stage.h"
#include "ngs/problem/view_list.h"
#include "support/same_evidence.h"
#include "support/splat_reference.h"

namespace ngs {
namespace {

/// Two overlapping binary objects and, in one corner, unknown pixels.
ViewMasks two_discs(const Camera& camera, double shift) {
  ViewMasks m{.width_px = camera.width_px, .height_px = camera.height_px, .target = {}, .known = {}, .available = true};
  m.target.resize(2);
  for (int y = 0; y < camera.height_px; ++y)
    for (int x = 0; x < camera.width_px; ++x) {
      m.target[0].push_back(std::hypot(x - 20 - shift, y - 20) < 13 ? 1.f : 0.f);
      m.target[1].push_back(std::hypot(x - 38 + shift, y - 22) < 9 ? 1.f : 0.f);
      m.known.push_back(x + y > 12);
    }
  return m;
}

struct BruteForce {
  std::vector<double> weight, object_weight;
  std::vector<std::uint64_t> pixels, object_pixels;
  bool near_threshold = false;
};

void add_brute_force(const test::SplatCase& c, const ViewMasks& masks, BruteForce& sums) {
  const auto image = test::reference_render(c, {});
  for (std::size_t i = 0; i < image.size(); ++i) {
    sums.near_threshold |= image[i].closest_threshold < 1e-5;
    if (!masks.known[i]) continue;
    for (const auto& [g, w] : image[i].weight) {
      const auto row = std::size_t(g);
      sums.weight[row] += w;
      sums.pixels[row] += 1;
      for (std::size_t k = 0; k < 2; ++k) {
        sums.object_weight[row * 2 + k] += w * masks.target[k][i];
        sums.object_pixels[row * 2 + k] += masks.target[k][i] > 0;
      }
    }
  }
}

}  // namespace

// A pixel's weight alpha · T carries an absolute float error below 1e-6 (the worst factor is 1 - alpha at alpha =
// 0.99), so a sum over n pixels is within n · 1e-6. Counts are exact unless some contribution lies within rounding of
// the 1/255 or 1e-4 thresholds; such scenes are recognised from the reference and must be rare.
TEST_CASE("evidence equals a brute-force evaluation in double: counts exactly, weights to 1e-6 per pixel") {
  int compared = 0, scenes_at_a_threshold = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    CAPTURE(seed);
    const test::SplatCase base = test::splat_case(seed, 80, 61, 47);
    BruteForce want{std::vector<double>(80), std::vector<double>(160), std::vector<std::uint64_t>(80),
                    std::vector<std::uint64_t>(160)};
    Evidence got(80, 2);
    const GaussianCloud cloud = test::float_cloud(base);
    for (int view = 0; view < 4; ++view) {
      test::SplatCase c = base;
      c.camera.cx += 3 * view;
      c.camera.fy *= 1 - 0.05 * view;
      ViewMasks masks = two_discs(c.camera, 2.0 * view);
      if (view == 3) std::fill(masks.target[0].begin(), masks.target[0].end(), 1.f);  // tiles that an object covers
      add_brute_force(c, masks, want);
      add_view_evidence({.threads = 2}, cloud, {c.camera, masks}, {}, got);
    }
    if (want.near_threshold) {
      ++scenes_at_a_threshold;
      continue;
    }
    for (std::size_t i = 0; i < 80; ++i) {
      const double tolerance = 1e-6 * double(want.pixels[i]);
      CHECK(got.pixels[i] == want.pixels[i]);
      CHECK(std::abs(got.weight.value(i) - want.weight[i]) <= tolerance);
      for (std::size_t k = 0; k < 2; ++k) {
        CHECK(test::object_pixels(got, i, k) == want.object_pixels[i * 2 + k]);
        CHECK(std::abs(got.object_weight(i, k) - want.object_weight[i * 2 + k]) <= tolerance);
      }
      compared += want.pixels[i] > 0;
    }
    VarianceOptions options;
    options.exclusive = false;
    const auto labels = label_gaussians(options, got);
    for (std::size_t i = 0; i < 80; ++i) {
      if (want.weight[i] == 0) continue;
      const double f = want.object_weight[i * 2] / want.weight[i];
      if (std::abs(f - 0.5) > 1e-5) CHECK(labels[0].label[i] == float(f > 0.5));
      CHECK(std::abs(double(labels[0].variance[i]) - 4 * f * (1 - f)) < 1e-5);
    }
  }
  CHECK(compared > 500);
  CHECK(scenes_at_a_threshold <= 3);
}

// As above: T is within 1e-6, and its square within twice that.
TEST_CASE("evidence by visibility: weights equal the sum of alpha T^2 evaluated in double") {
  int compared = 0, different = 0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    CAPTURE(seed);
    const test::SplatCase c = test::splat_case(seed, 80, 61, 47);
    const ViewMasks masks = two_discs(c.camera, 1);
    std::vector<double> want(80 * 3), rendered(80);
    double closest = 1;
    const auto image = test::reference_render(c, {});
    for (std::size_t p = 0; p < image.size(); ++p) {
      closest = std::min(closest, image[p].closest_threshold);
      double left = 1;
      for (const auto& [g, w] : image[p].weight) {
        const auto row = std::size_t(g);
        const double by_visibility = masks.known[p] ? w * left : 0;
        want[row * 3] += by_visibility;
        rendered[row] += masks.known[p] ? w : 0;
        for (std::size_t k = 0; k < 2; ++k) want[row * 3 + 1 + k] += by_visibility * double(masks.target[k][p]);
        left -= w;  // alpha T is what T falls by
      }
    }
    if (closest < 1e-5) continue;
    const MaskedView by_visibility{c.camera, masks, PixelWeight::kByVisibility};
    const ViewSums sums = view_sums({.threads = 2}, test::float_cloud(c), by_visibility, {});
    for (std::size_t v = 0; v < sums.size(); ++v) {
      const std::size_t row = sums.row[v];
      const double tolerance = 2e-6 * sums.at(v)[1];
      CHECK(std::abs(sums.weight(v) - want[row * 3]) <= tolerance);
      for (std::size_t k = 0; k < 2; ++k)
        CHECK(std::abs(sums.object_weight(v, k) - want[row * 3 + 1 + k]) <= tolerance);
      ++compared;
      different += rendered[row] > 1.1 * want[row * 3];
    }
  }
  CHECK(compared > 200);
  CHECK(different > 50);  // weights alpha T would fail
}

TEST_CASE("evidence of selected Gaussians is bit-identical to their rows of the evidence of all") {
  const test::SplatCase c = test::splat_case(5, 300, 160, 120);
  const GaussianCloud cloud = test::float_cloud(c);
  const RowNumbers some({7, 150}, 300);  // most tiles have neither
  for (const std::size_t objects : {1, 6})
    for (const PixelWeight weight : {PixelWeight::kRendered, PixelWeight::kByVisibility}) {
      ViewMasks masks = two_discs(c.camera, 1);
      masks.target.resize(objects, masks.target[0]);
      const MaskedView view{c.camera, masks, weight};
      const ViewSums all = view_sums({}, cloud, view, {}), few = view_sums({.threads = 2}, cloud, view, {}, &some);
      std::size_t v = 0;
      for (std::size_t a = 0; a < all.size(); ++a) {
        if (!some.has(all.row[a])) continue;
        REQUIRE(v < few.size());
        CHECK(few.row[v] == some.number[all.row[a]]);
        for (std::size_t s = 0; s < all.columns(); ++s) CHECK(few.at(v)[s] == all.at(a)[s]);
        ++v;
      }
      CHECK(v == few.size());
      CHECK(v > 0);
    }
}

TEST_CASE("evidence: contrast_sum from the stored sums of 1 - contrast is exact, for few and many objects") {
  const test::SplatCase c = test::splat_case(4, 80, 61, 47);
  const GaussianCloud cloud = test::float_cloud(c);
  for (const std::size_t objects : {1, 2, 7}) {
    CAPTURE(objects);
    Evidence evidence(80, int(objects));
    std::vector<std::uint64_t> want(80 * objects);
    std::size_t background = 0, object = 0;
    for (int view = 0; view < 4; ++view) {
      ViewMasks masks = two_discs(c.camera, view);
      masks.target.resize(objects, std::vector<float>(masks.target[0].size()));
      add_view_evidence({}, cloud, {c.camera, masks}, {}, evidence);
      const ViewSums sums = view_sums({}, cloud, {c.camera, masks}, {});
      for (std::size_t v = 0; v < sums.size(); ++v)
        for (std::size_t k = 0; k < objects; ++k) {
          const double all = sums.at(v)[1], inside = sums.at(v)[3 + 2 * k];
          want[sums.row[v] * objects + k] += std::uint64_t(std::llround(std::abs(2 * inside - all) / all * 0x1p32));
          ++(inside > 0 ? object : background);
        }
    }
    CHECK(background > 10);
    CHECK(object > 10);
    for (std::size_t i = 0; i < 80; ++i)
      for (std::size_t k = 0; k < objects; ++k) CHECK(evidence.contrast_sum(i, k) == want[i * objects + k]);
  }
}

TEST_CASE("label_gaussians throws for a threshold that the normalised variance cannot reach") {
  VarianceOptions options;
  options.tau = 1.0;
  CHECK_THROWS_AS(label_gaussians(options, Evidence(1, 1)), Error);
}

TEST_CASE("label_gaussians: a Gaussian without evidence has views = 0 and is not in the boundary") {
  const auto labels = label_gaussians({}, Evidence(2, 1));
  CHECK(labels[0].views[0] == 0.f);
  CHECK(labels[0].boundary[1] == 0.f);
}

TEST_CASE("label_gaussians: exclusive labels assign a Gaussian to the object of largest weight") {
  Evidence e(3, 2);
  const double weight[3] = {10, 10, 10}, object[3][2] = {{4, 5}, {3, 3}, {6, 6}};  // backgrounds 1, 4, -2 (overlap)
  for (std::size_t i = 0; i < 3; ++i) {
    e.weight.add(i, weight[i]);
    e.views[i] = 1;
    for (std::size_t k = 0; k < 2; ++k) e.object_weights.touch(i, k).weight.add(object[i][k]);
  }
  const auto exclusive = label_gaussians({}, e);
  CHECK(exclusive[0].label == std::vector<float>{0, 0, 1});  // a tie goes to the first object
  CHECK(exclusive[1].label == std::vector<float>{1, 0, 0});
  VarianceOptions independent;
  independent.exclusive = false;
  CHECK(label_gaussians(independent, e)[1].label == std::vector<float>{0, 0, 1});
}

TEST_CASE("with_objects keeps the named objects in the scene's order and throws for unknown names") {
  Scene scene;
  scene.objects = {{"cup", 3}, {"spoon", 5}, {"plate", 9}};
  CHECK(with_objects(scene, {}).objects.size() == 3);
  const Scene two = with_objects(scene, {"plate", "cup"});
  REQUIRE(two.objects.size() == 2);
  CHECK(two.objects[0].id == 3);
  CHECK(two.objects[1].id == 9);
  CHECK_THROWS_AS(with_objects(scene, {"fork"}), Error);
}

TEST_CASE("evidence: every instruction set gives the bytes of plain C++") {
  const test::SplatCase c = test::splat_case(9, 400, 70, 45);
  const GaussianCloud cloud = test::float_cloud(c);
  for (const int objects : {1, 2, 3}) {  // one object has a kernel of its own
    ViewMasks masks = two_discs(c.camera, 2);
    masks.target.resize(std::size_t(objects), masks.target[0]);
    Evidence a(cloud.size(), objects);
    add_view_evidence({.isa = Isa::kPortable}, cloud, {c.camera, masks}, {}, a);
    for (const Isa isa : {Isa::kNeon, Isa::kV3, Isa::kV4}) {
      if (!can_run(isa)) continue;
      Evidence b(cloud.size(), objects);
      add_view_evidence({.isa = isa}, cloud, {c.camera, masks}, {}, b);
      CHECK(test::same_evidence(a, b));
      const auto by_visibility = [&](Isa of) {
        return view_sums({.isa = of}, cloud, {c.camera, masks, PixelWeight::kByVisibility}, {}).sum;
      };
      CHECK(by_visibility(isa) == by_visibility(Isa::kPortable));
    }
  }
}

TEST_CASE("evidence: packed weights are bit-identical to the sums") {
  const test::SplatCase c = test::splat_case(5, 120, 61, 47);
  const GaussianCloud cloud = test::float_cloud(c);
  const ViewMasks two = two_discs(c.camera, 1);
  std::vector<std::uint8_t> chosen(120);
  for (std::size_t i = 0; i < chosen.size(); ++i) chosen[i] = i % 3 != 0;
  const RowNumbers some(chosen);
  for (const std::size_t objects : {1, 2, 6})
    for (const RowNumbers* of : {static_cast<const RowNumbers*>(nullptr), &some}) {
      ViewMasks masks = two;
      for (std::size_t k = 0; k < objects; ++k) masks.target.push_back(two.target[k % 2]);
      masks.target.erase(masks.target.begin(), masks.target.begin() + 2);
      const ViewSums sums = view_sums({}, cloud, {c.camera, masks}, {}, of);
      const PackedSums packed = packed_sums({.threads = 3}, cloud, {c.camera, masks}, {}, of);
      std::size_t v = 0;
      for (std::size_t part = 0; part < packed.parts(); ++part)
        packed.for_each(part, [&](std::uint32_t gaussian, const double* weight) {
          REQUIRE(v < sums.size());
          CHECK(gaussian == sums.row[v]);
          CHECK(weight[0] == sums.weight(v));
          for (std::size_t k = 0; k < objects; ++k) CHECK(weight[1 + k] == sums.object_weight(v, k));
          ++v;
        });
      CHECK(v == sums.size());
      CHECK(v > 20);
    }
}

}  // namespace ngs
