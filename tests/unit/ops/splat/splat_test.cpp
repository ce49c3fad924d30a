#include "ngs/ops/splat/splat.h"

#include <doctest/doctest.h>

#include <cmath>

#include "support/skip.h"
#include "support/splat_reference.h"

namespace ngs {
namespace {

/// Renders rgb, two labels, depth and alpha with lane type L; [7][pixels].
template <class L>
std::vector<std::vector<typename LaneTraits<L>::Scalar>> rendered(const test::SplatCase& c, const SplatOptions& options,
                                                                  int threads = 1) {
  using S = typename LaneTraits<L>::Scalar;
  test::SplatArrays<S> arrays(c);
  SplatEngine<S> engine(tile_kernels_of<L>(), options, arrays.cloud(), c.camera, arrays.request({0, 0, 0}));
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

TEST_CASE("splat: every lane of a pack is bit-identical to the scalar kernel") {
  const test::SplatCase c = test::splat_case(3, 200, 71, 50);
  CHECK(rendered<PackF>(c, {}) == rendered<float>(c, {}));
}

namespace {

struct WholeView {
  RenderedView image;
  CloudGradients gradient;
};

/// Forward and backward through SplatPass with 3, 4, 5 or 8 channels.
WholeView whole_view(const test::SplatCase& c, const Exec& exec, int labels, bool depth,
                     const GradientRows& wanted = {}) {
  const GaussianCloud cloud = test::float_cloud(c);
  std::vector<float> label(std::size_t(c.gaussians * labels));
  for (std::size_t i = 0; i < label.size(); ++i) label[i] = float(c.label[i % c.label.size()]);
  RenderRequest request{
      .depth = depth, .label = {label.data(), labels > 0 ? cloud.size() : 0, labels}, .background = {0.2f, 0.4f, 0.1f}};
  SplatPass pass(SplatOptions{});
  WholeView out{.image = pass.forward(exec, cloud, c.camera, request), .gradient = {}};
  ViewGradients gradients;
  gradients.colour = out.image.colour;
  gradients.label = out.image.label;
  gradients.depth = out.image.depth;
  gradients.alpha = out.image.alpha;
  pass.backward(exec, gradients, out.gradient, wanted);
  return out;
}

}  // namespace

TEST_CASE("splat: every instruction set gives the bytes of plain C++, forward and backward") {
  std::vector<Isa> sets;
  for (const Isa isa : {Isa::kNeon, Isa::kV3, Isa::kV4})
    if (can_run(isa)) sets.push_back(isa);
  if (sets.empty()) return test::skip("this build has the portable kernels only");
  for (std::uint64_t seed = 0; seed < 6; ++seed)
    for (const int labels : {0, 1, 2, 4}) {
      CAPTURE(seed);
      CAPTURE(labels);
      // needles and large Gaussians; a width that ends inside a pack; many in one tile, so that the tape must grow
      const test::SplatCase c =
          test::splat_case(seed, 40 + int(seed) * 150, seed % 2 ? 75 : 18, 50, seed % 3 ? 1.0 : 0.1);
      const WholeView a = whole_view(c, {.threads = 1, .isa = Isa::kPortable}, labels, labels == 1);
      for (const Isa isa : sets) {
        CAPTURE(isa);
        const WholeView b = whole_view(c, {.threads = 2, .isa = isa}, labels, labels == 1);
        CHECK(a.image.colour.data == b.image.colour.data);
        CHECK(a.image.label.data == b.image.label.data);
        CHECK(a.image.alpha.data == b.image.alpha.data);
        CHECK(a.gradient.position == b.gradient.position);
        CHECK(a.gradient.rotation == b.gradient.rotation);
        CHECK(a.gradient.log_scale == b.gradient.log_scale);
        CHECK(a.gradient.logit_opacity == b.gradient.logit_opacity);
        CHECK(a.gradient.sh_rest == b.gradient.sh_rest);
        CHECK(a.gradient.label == b.gradient.label);
      }
      CHECK(std::any_of(a.gradient.position.begin(), a.gradient.position.end(), [](float g) { return g != 0; }));
    }
}

TEST_CASE("splat: label_only zeroes all but label gradients and leaves other Gaussians' gradients unchanged") {
  const test::SplatCase c = test::splat_case(5, 200, 71, 50);
  std::vector<std::uint8_t> alone(200);
  for (std::size_t i = 0; i < alone.size(); ++i) alone[i] = i % 3 == 0;
  for (const int labels : {0, 2}) {
    const CloudGradients all = whole_view(c, {.threads = 1, .isa = best_isa()}, labels, true).gradient,
                         some = whole_view(c, {.threads = 2, .isa = best_isa()}, labels, true, {.label_only = alone})
                                    .gradient;
    CHECK(some.label == all.label);
    CHECK(some.visible == all.visible);
    for (const auto column :
         {&CloudGradients::position, &CloudGradients::rotation, &CloudGradients::log_scale,
          &CloudGradients::logit_opacity, &CloudGradients::sh_dc, &CloudGradients::sh_rest, &CloudGradients::mean_px}) {
      std::vector<float> want = all.*column;
      const std::size_t width = want.size() / alone.size();
      REQUIRE(std::any_of(want.begin(), want.end(), [](float g) { return g != 0; }));
      for (std::size_t i = 0; i < want.size(); ++i)
        if (alone[i / width]) want[i] = 0;
      CHECK(some.*column == want);
    }
  }
}

TEST_CASE("splat: without sh_rest, positions lose only their gradient through the SH bands") {
  test::SplatCase c = test::splat_case(5, 200, 71, 50);
  for (const bool with_bands : {true, false}) {
    if (!with_bands) std::fill(c.sh_rest.begin(), c.sh_rest.end(), 0.0);
    const CloudGradients all = whole_view(c, {.threads = 1, .isa = best_isa()}, 1, true).gradient,
                         some = whole_view(c, {.threads = 2, .isa = best_isa()}, 1, true, {.sh_rest = false}).gradient;
    CHECK(some.sh_rest.empty());
    CHECK((some.position == all.position) == !with_bands);
    for (const auto column : {&CloudGradients::rotation, &CloudGradients::log_scale, &CloudGradients::logit_opacity,
                              &CloudGradients::sh_dc, &CloudGradients::label, &CloudGradients::mean_px})
      CHECK(some.*column == all.*column);
  }
}

TEST_CASE("splat gives the same bits for any number of threads") {
  const test::SplatCase c = test::splat_case(4, 300, 90, 70);
  const auto one = rendered<PackF>(c, {}, 1);
  for (const int threads : {2, 3, 7}) CHECK(rendered<PackF>(c, {}, threads) == one);
}

TEST_CASE("splat: many sparse label channels are bit-identical to each channel rendered alone") {
  const test::SplatCase c = test::splat_case(4, 200, 71, 50);
  const GaussianCloud cloud = test::float_cloud(c);
  constexpr std::size_t kObjects = 9;
  const auto n = std::size_t(c.gaussians);
  std::vector<float> all(n * kObjects, 0.f);
  for (std::size_t i = 0; i < n; ++i)  // of none, one, four or more objects
    for (std::size_t k = 0; k < i % 7; ++k) all[i * kObjects + (i + 2 * k) % kObjects] = 0.25f + 0.125f * float(k);
  for (const Isa isa : {Isa::kV3, best_isa()}) {
    const Exec exec{.threads = 2, .isa = isa};
    RenderRequest together{.colour = false, .label = {all.data(), cloud.size(), int(kObjects)}};
    const ImageF image = render(exec, cloud, c.camera, {}, together).label;
    for (std::size_t k = 0; k < kObjects; ++k) {
      std::vector<float> one(n);
      for (std::size_t i = 0; i < n; ++i) one[i] = all[i * kObjects + k];
      RenderRequest alone{.colour = false, .label = {one.data(), cloud.size(), 1}};
      const ImageF want = render(exec, cloud, c.camera, {}, alone).label;
      std::vector<float> got(want.data.size());
      for (std::size_t p = 0; p < got.size(); ++p) got[p] = image.data[p * kObjects + k];
      CHECK(got == want.data);
      CHECK(std::any_of(got.begin(), got.end(), [](float x) { return x > 0.01f; }));
    }
  }
}

}  // namespace ngs
