#include <doctest/doctest.h>

#include <cmath>

#include "support/splat_reference.h"

namespace ngs {
namespace {

/// Renders rgb, two labels, depth and alpha with lane type L; [7][pixels].
template <class L>
std::vector<std::vector<typename LaneTraits<L>::Scalar>> rendered(const test::SplatCase& c, const SplatOptions& options,
                                                                   int threads = 1) {
  using S = typename LaneTraits<L>::Scalar;
  test::SplatArrays<S> arrays(c);
  SplatEngine<L> engine(options, arrays.cloud(), c.camera, arrays.request({0, 0, 0}));
  std::vector<std::vector<S>> image(7, std::vector<S>(std::size_t(c.camera.width_px * c.camera.height_px), S(NAN)));
  std::vector<Plane<S>> planes;
  for (auto& i : image) planes.push_back({i.data(), 1});
  engine.forward({.threads = threads}, planes);
  return image;
}

template <class S>
double worst_difference(const std::vector<std::vector<S>>& image, const std::vector<test::ReferencePixel>& reference) {
  double worst = 0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const test::ReferencePixel& r = reference[i];
    const double want[7] = {r.rgb[0], r.rgb[1], r.rgb[2], r.label[0], r.label[1], r.depth, 1 - r.transmittance};
    for (std::size_t k = 0; k < 7; ++k) worst = std::max(worst, std::abs(double(image[k][i]) - want[k]));
  }
  return worst;
}

}  // namespace

TEST_CASE("splat in double equals the rendering equation evaluated at every pixel") {
  for (const Compat compat : {Compat::kInria, Compat::kGsplat})
    for (const bool antialiased : {false, true})
      for (std::uint64_t seed = 0; seed < 20; ++seed) {
        CAPTURE(seed);
        const SplatOptions options{compat, antialiased, 3};
        const test::SplatCase c = test::splat_case(seed, int(seed) * 12, 53, 41);  // seed 0: no Gaussian at all
        CHECK(worst_difference(rendered<double>(c, options), test::reference_render(c, options)) < 1e-12);
      }
}

TEST_CASE("splat in float packs stays within the threshold band of the double reference") {
  // Most pixels differ by rounding only; where alpha crosses 1/255 or T crosses 1e-4 a contribution of at most
  // 1/255 of a colour (about 2 here) or 1e-4 may flip.
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    CAPTURE(seed);
    const test::SplatCase c = test::splat_case(seed, 150, 53, 41);
    const auto image = rendered<PackF>(c, {});
    const auto reference = test::reference_render(c, {});
    int outside = 0;
    for (std::size_t i = 0; i < reference.size(); ++i)
      outside += std::abs(double(image[0][i]) - reference[i].rgb[0]) > 2e-5;
    CHECK(outside <= 2);
    CHECK(worst_difference(image, reference) < 0.02);
  }
}

TEST_CASE("splat: a pack lane computes bit for bit what one float computes") {
  const test::SplatCase c = test::splat_case(3, 200, 71, 50);
  CHECK(rendered<PackF>(c, {}) == rendered<float>(c, {}));
}

TEST_CASE("splat gives the same bits for any number of threads") {
  const test::SplatCase c = test::splat_case(4, 300, 90, 70);
  const auto one = rendered<PackF>(c, {}, 1);
  for (const int threads : {2, 3, 7}) CHECK(rendered<PackF>(c, {}, threads) == one);
}

TEST_CASE("splat: Gaussians at equal depth are composited in index order") {
  test::SplatCase c = test::splat_case(8, 2, 20, 20);
  for (int k = 0; k < 3; ++k) c.position[std::size_t(3 + k)] = c.position[std::size_t(k)];
  c.logit_opacity = {9, 9};
  const auto reference = test::reference_render(c, {});
  CHECK(worst_difference(rendered<double>(c, {}), reference) < 1e-12);
}

}  // namespace ngs
