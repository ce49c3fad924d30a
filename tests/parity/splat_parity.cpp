// Device against CPU: images, gradients and evidence of whole views. Depths, and therefore the order of Gaussians, use
// no functions that differ between devices. Alphas differ by the rounding of exp and log.
#include <doctest/doctest.h>

#include "ngs/ops/splat/evidence.h"
#include "ngs/ops/splat/front_layer.h"
#include "ngs/ops/splat/tile_types.h"
#include "parity/backends.h"
#include "support/random.h"
#include "support/same_evidence.h"
#include "support/splat_reference.h"

namespace ngs::test {
namespace {

struct View {
  RenderedView image;
  CloudGradients gradient;
};

struct Channels {
  bool colour, depth;
  int labels;
  Compat compat = Compat::kInria;
  bool antialiased = false;
};

View run_view(const Exec& exec, const SplatCase& c, const Channels& channels, const ViewGradients& upstream,
              const GradientRows& wanted = {}) {
  const GaussianCloud cloud = float_cloud(c);
  Random random(7);
  const auto label = random.uniform_vector<float>(std::size_t(c.gaussians * channels.labels), 0, 1);
  RenderRequest request;
  request.colour = channels.colour;
  request.depth = channels.depth;
  request.background = {0.3f, 0.1f, 0.7f};
  if (channels.labels > 0) request.label = {label.data(), c.gaussians, channels.labels};
  SplatPass pass({.compat = channels.compat, .antialiased = channels.antialiased});
  View view{.image = pass.forward(exec, cloud, c.camera, request), .gradient = {}};
  pass.backward(exec, upstream, view.gradient, wanted);
  return view;
}

ViewGradients random_gradients(const SplatCase& c, const Channels& channels) {
  Random random(9);
  const auto image = [&](int count) {
    ImageF out(c.camera.width_px, c.camera.height_px, count);
    for (float& x : out.data) x = float(random.uniform(-1, 1));
    return out;
  };
  ViewGradients g;
  if (channels.colour) g.colour = image(3);
  if (channels.labels > 0) g.label = image(channels.labels);
  if (channels.depth) g.depth = image(1);
  g.alpha = image(1);
  g.label_moves_geometry = channels.labels > 1;
  return g;
}

/// Pixels where alpha or transmittance is within 1e-4 of a threshold: they may have one contribution more or less.
std::vector<std::uint8_t> near_threshold(const SplatCase& c, const SplatOptions& options) {
  std::vector<std::uint8_t> near;
  for (const ReferencePixel& p : reference_render(c, options)) near.push_back(p.closest_threshold < 1e-4);
  return near;
}

double image_ratio(const ImageF& got, const ImageF& want, const std::vector<std::uint8_t>& skip) {
  double worst = 0;
  const double scale = std::max(1.0, largest(want.data)) * double(std::numeric_limits<float>::epsilon());
  for (std::size_t i = 0; i < want.data.size(); ++i) {
    const double error = std::abs(double(got.data[i]) - double(want.data[i]));
    if (!std::isfinite(error)) return std::numeric_limits<double>::infinity();
    if (!skip[i / std::size_t(want.channels)]) worst = std::max(worst, error / scale);
  }
  return worst;
}

/// A wrong factor may hide within a bound that scales with the largest value.
void check_unbiased(const std::vector<float>& got, const std::vector<float>& want) {
  const double least = 1e-3 * largest(want);
  double product = 0, square = 0, ratios = 0;
  std::int64_t count = 0;
  for (std::size_t i = 0; i < want.size(); ++i) {
    const double g = double(got[i]), w = double(want[i]);
    product += g * w;
    square += w * w;
    if (std::abs(w) > least) {
      ratios += g / w;
      ++count;
    }
  }
  if (count == 0) return;
  CHECK(product > 0);
  CHECK(product / square == doctest::Approx(1).epsilon(0.01));
  CHECK(ratios / double(count) == doctest::Approx(1).epsilon(0.01));
}

constexpr Channels kChannels[] = {{true, false, 0},  {true, true, 1},  {false, false, 1}, {false, true, 0},
                                  {false, false, 0}, {true, false, 1}, {true, true, 9}};
constexpr int kSizes[] = {0, 1, 7, 150, 700};  // none, one, a partial chunk, several batches per tile

}  // namespace

TEST_CASE("splat: images of a device equal the CPU's within rounding") {
  for (const Backend& b : backends())
    for (const Compat compat : {Compat::kInria, Compat::kGsplat})
      for (const int gaussians : kSizes)
        for (const Channels& channels : kChannels) {
          const SplatOptions options{.compat = compat, .antialiased = gaussians == 7};
          const SplatCase c = splat_case(std::uint64_t(gaussians) + 1, gaussians, 53, 41, gaussians == 700 ? 0.2 : 1.0);
          const Channels rendered{channels.colour, channels.depth, channels.labels, compat, options.antialiased};
          const ViewGradients upstream = random_gradients(c, channels);
          const View expected = run_view({}, c, rendered, upstream);
          const View got = run_view(b.exec, c, rendered, upstream);
          const auto skip = near_threshold(c, options);
          CAPTURE(gaussians);
          CAPTURE(channels.labels);
          // alpha = o e^power, |power| <= 5.6: relative error ~ 6 eps per unit of the exponent; some tens of terms
          check_ratio(b, "splat colour", image_ratio(got.image.colour, expected.image.colour, skip), 500);
          check_ratio(b, "splat label", image_ratio(got.image.label, expected.image.label, skip), 500);
          check_ratio(b, "splat depth", image_ratio(got.image.depth, expected.image.depth, skip), 500);
          check_ratio(b, "splat alpha", image_ratio(got.image.alpha, expected.image.alpha, skip), 500);
          if (!b.same_functions) continue;
          CHECK(got.image.colour.data == expected.image.colour.data);
          CHECK(got.image.label.data == expected.image.label.data);
          CHECK(got.image.depth.data == expected.image.depth.data);
          CHECK(got.image.alpha.data == expected.image.alpha.data);
        }
}

TEST_CASE("splat: gradients of a device equal the CPU's, bit by bit with its functions and in order") {
  std::vector<Backend> all = backends();
  all.insert(all.end(), atomic_backends().begin(), atomic_backends().end());
  for (const Backend& b : all)
    for (const int gaussians : kSizes)
      for (const Channels& channels : kChannels) {
        const SplatCase c = splat_case(std::uint64_t(gaussians) + 1, gaussians, 53, 41, gaussians == 700 ? 0.2 : 1.0);
        const ViewGradients upstream = random_gradients(c, channels);
        const GradientRows wanted{.sh_rest = gaussians != 150};  // once without SH bands
        const CloudGradients want = run_view({}, c, channels, upstream, wanted).gradient;
        const CloudGradients got = run_view(b.exec, c, channels, upstream, wanted).gradient;
        CAPTURE(gaussians);
        CAPTURE(channels.labels);
        // sums of some hundred terms of either sign, then the chain rule of the projection; a pixel at a
        // threshold may flip
        const double bound = b.same_functions ? 200 : 2e4;
        const bool same_sums = b.same_functions && b.ordered && channels.labels < 9;  // 9: two launches
        const auto column = [&](const char* name, const std::vector<float>& g, const std::vector<float>& w) {
          if (same_sums) CHECK(g == w);
          check_ratio(b, std::string("splat gradient, ") + name, worst_ratio(g, w, std::max(largest(w), 1e-3)), bound);
          check_unbiased(g, w);
        };
        column("position", got.position, want.position);
        column("rotation", got.rotation, want.rotation);
        column("log_scale", got.log_scale, want.log_scale);
        column("opacity", got.logit_opacity, want.logit_opacity);
        column("sh_dc", got.sh_dc, want.sh_dc);
        column("sh_rest", got.sh_rest, want.sh_rest);
        column("label", got.label, want.label);
        column("mean_px", got.mean_px, want.mean_px);
        int differ = 0;
        for (std::size_t i = 0; i < want.visible.size(); ++i) differ += got.visible[i] != want.visible[i];
        CHECK(differ <= (b.same_functions ? 0 : 2));  // an ellipse may just touch a tile
      }
}

TEST_CASE("splat: images and gradients of a device do not depend on the order of threads") {
  if (backends().size() < 2) return;
  const SplatCase c = splat_case(4, 300, 71, 50);
  const Channels channels{true, true, 2};
  const ViewGradients upstream = random_gradients(c, channels);
  const View first = run_view(backends()[0].exec, c, channels, upstream);
  for (const Backend& b : backends()) {
    const View other = run_view(b.exec, c, channels, upstream);
    CHECK(other.image.colour.data == first.image.colour.data);
    CHECK(other.gradient.position == first.gradient.position);
    CHECK(other.gradient.sh_rest == first.gradient.sh_rest);
    CHECK(other.gradient.label == first.gradient.label);
  }
}

/// Upstream gradients that are zero beyond one tile.
ViewGradients of_tile(ViewGradients g, int tile_x, int tile_y) {
  for (ImageF* image : {&g.colour, &g.label, &g.depth, &g.alpha})
    for (int y = 0; y < image->height_px; ++y)
      for (int x = 0; x < image->width_px; ++x)
        if (x / kTilePx != tile_x || y / kTilePx != tile_y) std::fill_n(&image->at(x, y), image->channels, 0.f);
  return g;
}

TEST_CASE("splat: atomic sums of a device equal ordered sums within the rounding of their terms") {
  const SplatCase c = splat_case(4, 300, 71, 50);
  const Channels channels{true, true, 2};  // one launch: a tile adds once
  const ViewGradients upstream = random_gradients(c, channels);
  const auto sums = [&](const Exec& exec, const ViewGradients& up) {  // gradients that are plain sums over tiles
    CloudGradients g = run_view(exec, c, channels, up).gradient;
    g.label.insert(g.label.end(), g.mean_px.begin(), g.mean_px.end());
    return g.label;
  };
  const std::vector<float> ordered = sums(backends()[0].exec, upstream);
  std::vector<double> terms(ordered.size());
  std::vector<int> count(ordered.size());
  for (int y = 0; y * kTilePx < 50; ++y)
    for (int x = 0; x * kTilePx < 71; ++x) {
      const std::vector<float> term = sums(backends()[0].exec, of_tile(upstream, x, y));
      for (std::size_t i = 0; i < term.size(); ++i) {
        terms[i] += std::abs(double(term[i]));
        count[i] += term[i] != 0.f;
      }
    }
  // Ordered sums round once, atomic sums n - 1 times, each by half an eps of at most the sum of the terms' magnitudes.
  const auto worst_share = [&](const std::vector<float>& got) {
    double worst = 0;
    for (std::size_t i = 0; i < got.size(); ++i)
      if (const double error = std::abs(double(got[i]) - double(ordered[i])); error > 0)
        worst = std::max(worst, error / (0.5 * count[i] * double(std::numeric_limits<float>::epsilon()) * terms[i]));
    return worst;
  };
  CHECK(*std::max_element(count.begin(), count.end()) > 4);
  for (const Backend& b : atomic_backends()) {
    check_ratio(b, "splat sums over tiles, atomic", worst_share(sums(b.exec, upstream)), 1);
    ViewGradients without = upstream;  // the bound must detect a tile that is left out
    const ViewGradients tile = of_tile(upstream, 2, 1);
    for (std::size_t i = 0; i < tile.label.data.size(); ++i) without.label.data[i] -= tile.label.data[i];
    CHECK(worst_share(sums(b.exec, without)) > 1000);
  }
  if (atomic_backends().size() > 1)
    CHECK(sums(atomic_backends()[0].exec, upstream) != sums(atomic_backends()[1].exec, upstream));
}

TEST_CASE("splat: without upstream gradients, the gradients of a device are zero") {
  const SplatCase c = splat_case(2, 100, 53, 41);
  for (const Backend& b : backends()) {
    const View view = run_view(b.exec, c, {true, false, 1}, {});
    CHECK(largest(view.gradient.position) == 0);
    CHECK(largest(view.gradient.sh_dc) == 0);
  }
}

TEST_CASE("splat: with label_only, a device computes the label gradient only") {
  const SplatCase c = splat_case(2, 100, 53, 41);
  const Channels channels{true, false, 2};
  const ViewGradients upstream = random_gradients(c, channels);
  for (const Backend& b : backends()) {
    const View all = run_view(b.exec, c, channels, upstream);
    const View none = run_view(b.exec, c, channels, upstream, {.label_only = std::vector<std::uint8_t>(100, 1)});
    CHECK(none.gradient.label == all.gradient.label);
    CHECK(largest(none.gradient.label) > 0);
    CHECK(largest(none.gradient.position) == 0);
    CHECK(largest(none.gradient.sh_dc) == 0);
  }
}

TEST_CASE("splat: with places, a device stores the gradients of these Gaussians alone, with the same bits") {
  const SplatCase c = splat_case(2, 100, 53, 41);
  const Channels channels{true, false, 2};
  const ViewGradients upstream = random_gradients(c, channels);
  GradientRows wanted;
  wanted.gradient_row.assign(100, -1);
  for (std::size_t i = 1; i < 100; i += 7) wanted.gradient_row[i] = std::int32_t(wanted.rows++);
  for (const Backend& b : backends()) {
    const CloudGradients all = run_view(b.exec, c, channels, upstream).gradient,
                         some = run_view(b.exec, c, channels, upstream, wanted).gradient;
    const auto check = [&](const std::vector<float>& of_all, const std::vector<float>& of_some) {
      const std::size_t width = of_all.size() / 100;
      REQUIRE(of_some.size() == width * std::size_t(wanted.rows));
      for (std::size_t i = 0; i < 100; ++i)
        for (std::size_t k = 0; k < width && wanted.gradient_row[i] >= 0; ++k)
          CHECK(of_some[std::size_t(wanted.gradient_row[i]) * width + k] == of_all[i * width + k]);
    };
    check(all.position, some.position);
    check(all.rotation, some.rotation);
    check(all.log_scale, some.log_scale);
    check(all.logit_opacity, some.logit_opacity);
    check(all.sh_dc, some.sh_dc);
    check(all.sh_rest, some.sh_rest);
    check(all.label, some.label);
    check(all.mean_px, some.mean_px);
    CHECK(largest(some.position) > 0);
  }
}

TEST_CASE("evidence of a device equals the CPU's, bit by bit with its functions") {
  for (const Backend& b : backends())
    for (const int objects : {0, 1, 2, 6})  // 6: two launches
      for (const int gaussians : {0, 1, 60, 700}) {
        const SplatCase c = splat_case(std::uint64_t(gaussians) + 5, gaussians, 53, 41, gaussians == 700 ? 0.2 : 1.0);
        const GaussianCloud cloud = float_cloud(c);
        Random random(3);
        ViewMasks masks{.width_px = 53, .height_px = 41, .target = {}, .known = {}, .available = true};
        for (int k = 0; k < objects; ++k)
          masks.target.push_back(random.uniform_vector<float>(std::size_t(53 * 41), 0, 1));
        if (objects != 2)
          for (int i = 0; i < 53 * 41; ++i) masks.known.push_back(random.below(4) != 0);
        Evidence want(cloud.size(), objects), got(cloud.size(), objects);
        const PixelWeight by = objects == 2 ? PixelWeight::kByVisibility : PixelWeight::kRendered;
        add_view_evidence({}, cloud, {c.camera, masks, by}, {}, want);
        add_view_evidence(b.exec, cloud, {c.camera, masks, by}, {}, got);
        EvidenceSum sum(b.exec, cloud, objects, {});
        sum.add({c.camera, masks, by});
        CHECK(same_evidence(sum.result(), got));
        std::vector<double> weight, weight_want, object, object_want;
        for (std::size_t i = 0; i < want.weight.size(); ++i) {
          weight.push_back(got.weight.value(i));
          weight_want.push_back(want.weight.value(i));
        }
        bool same_pixels = true;
        for (std::size_t i = 0; i < want.weight.size(); ++i)
          for (std::size_t k = 0; k < std::size_t(objects); ++k) {
            object.push_back(got.object_weight(i, k));
            object_want.push_back(want.object_weight(i, k));
            same_pixels &= test::object_pixels(got, i, k) == test::object_pixels(want, i, k);
          }
        CAPTURE(objects);
        CAPTURE(gaussians);
        check_ratio(b, "evidence W", worst_ratio(weight, weight_want, std::max(largest(weight_want), 1.0)), 500);
        check_ratio(b, "evidence W1", worst_ratio(object, object_want, std::max(largest(object_want), 1.0)), 500);
        std::int64_t flips = 0;
        for (std::size_t i = 0; i < want.pixels.size(); ++i)
          flips += std::abs(std::int64_t(got.pixels[i]) - std::int64_t(want.pixels[i]));
        CHECK(flips <= (b.same_functions ? 0 : 2));
        if (!b.same_functions) continue;
        CHECK(got.views == want.views);
        CHECK(same_pixels);
        CHECK(weight == weight_want);
        CHECK(object == object_want);
      }
}

// Device against CPU: the part of a view in front of a surface.

TEST_CASE("front view of a device equals the CPU's, bit by bit with its functions") {
  for (const Backend& b : backends())
    for (const int gaussians : {0, 1, 60, 700})
      for (const int columns : {0, 2, 4, 7}) {  // 7: two launches
        const SplatCase c = splat_case(std::uint64_t(gaussians) + 5, gaussians, 53, 41, gaussians == 700 ? 0.2 : 1.0);
        const GaussianCloud cloud = float_cloud(c);
        Random random(3);
        ImageF limit(53, 41, 1);
        std::vector<std::uint8_t> marked;
        for (float& z : limit.data) {
          z = random.below(7) == 0 ? 0.f : float(random.uniform(1.5, 7));  // the depths lie in 1.5 to 6
          marked.push_back(random.below(3) == 0);
        }
        Candidates candidate;
        for (int i = 0; i < gaussians; ++i) candidate.push_back(random.below(4) != 0);
        const RowNumbers of(candidate);
        const auto value = random.uniform_vector<float>(std::size_t(of.size() * columns), 0, 1);
        const auto layer = [&](const FrontView& view) {
          return columns > 0 ? view.layer({of, {value.data(), of.size(), columns}}) : view.layer(candidate);
        };
        const FrontView want({}, cloud, limit, c.camera, {}), got(b.exec, cloud, limit, c.camera, {});
        const ImageF want_layer = layer(want), got_layer = layer(got);
        ViewSums want_sums = want.sums(candidate, marked), got_sums = got.sums(candidate, marked);
        CAPTURE(gaussians);
        CAPTURE(columns);
        check_ratio(b, "front layer", worst_ratio(got_layer.data, want_layer.data, 1.0), 100);
        const auto by_row = [&](const ViewSums& sums) {
          std::vector<double> all(std::size_t(2 * gaussians));
          for (std::size_t v = 0; v < sums.size(); ++v) {
            all[2 * sums.row[v]] = sums.weight(v);
            all[2 * sums.row[v] + 1] = sums.object_weight(v, 0);
          }
          return all;
        };
        const std::vector<double> sums = by_row(want_sums);
        check_ratio(b, "front sums", worst_ratio(by_row(got_sums), sums, std::max(largest(sums), 1.0)), 500);
        if (gaussians == 700) CHECK(largest(sums) > 1);
        if (!b.same_functions) continue;
        CHECK(got_layer.data == want_layer.data);
        CHECK(by_row(got_sums) == sums);
      }
}

}  // namespace ngs::test
