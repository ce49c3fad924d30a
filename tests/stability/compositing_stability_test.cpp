// The compositing loops, forward and backward, one lane and eight.                     Eq. (2); paper.md §5.1
#include <doctest/doctest.h>

#include <numeric>

#include "ngs/ops/splat/cloud_view.h"
#include "ngs/ops/splat/splat_view.h"
#include "ngs/ops/splat/tile_isa.h"
#include "ngs/ops/splat/tile_kernels_of.h"
#include "ngs/ops/splat/tile_scratch.h"
#include "support/cameras.h"
#include "support/projected_view.h"
#include "support/splat_record.h"
#include "support/stability.h"

namespace ngs {
namespace {

using test::Random;
using test::Worst;
using Real = long double;

/// The kernels of every lane type that this machine supports; one lane first.
std::vector<TileKernels<float>> lane_types() {
  return {tile_kernels_of<float>(), tile_kernels_of<PackF>(), float_tile_kernels(best_isa())};
}

/// Gaussians over one tile in depth order, with one channel.
struct Stack {
  TileFrame frame{0, 0, kTilePx, kTilePx};
  struct Covariance {
    Real xx, xy, yy;
  };
  std::vector<SplatRecord<float>> record;
  std::vector<Covariance> covariance;
  std::vector<float> opacity, value;

  void add(double x, double y, double xx, double xy, double yy, float opacity, float channel) {
    record.push_back(test::splat_record(x, y, xx, xy, yy, opacity));
    covariance.push_back({xx, xy, yy});
    this->opacity.push_back(opacity);
    value.push_back(channel);
  }
  /// Adds an isotropic Gaussian of `sigma` px.
  void add_round(Random& random, double sigma, float opacity) {
    add(frame.x_px + random.uniform(0, 16), random.uniform(0, 16), sigma * sigma, 0, sigma * sigma, opacity,
        float(random.uniform(0.1, 1)));
  }

  /// [256] channel and transmittance of the tile's pixels. The kernel runs with three channels; the second shows only
  /// the background, so it holds the transmittance.
  struct Image {
    std::vector<float> channel = std::vector<float>(kTilePixels), transmittance = channel;
    bool operator==(const Image&) const = default;
  };
  Image composite(const TileKernels<float>& kernels) {
    static std::vector<float> memory[4];  // large enough for the widest image; only the tile is written
    for (auto& m : memory) m.resize(std::max(m.size(), std::size_t(frame.width_px) * kTilePx));
    const Plane<float> out[4] = {
        {memory[0].data(), 1}, {memory[1].data(), 1}, {memory[2].data(), 1}, {memory[3].data(), 1}};
    std::vector<float> scratch(3 * kTilePixels), values(3 * value.size(), 0.f);
    for (std::size_t i = 0; i < value.size(); ++i) values[i * 3] = value[i];
    const float background[3] = {0, 1, 0};
    kernels.forward({work(), {values.data(), 3}, background, out, scratch.data()});
    Image image;
    for (std::size_t p = 0; p < kTilePixels; ++p) {
      const std::size_t at = p / kTilePx * std::size_t(frame.width_px) + std::size_t(frame.x_px) + p % kTilePx;
      image.channel[p] = memory[0][at];
      image.transmittance[p] = memory[1][at];
    }
    return image;
  }
  /// o ∂L/∂o of every Gaussian, o its opacity, for L = g · channel at one pixel over `background`.
  std::vector<float> opacity_gradients(const TileKernels<float>& kernels, int pixel, float g, float background) {
    std::vector<float> grad(kTilePixels, 0.f), pair(record.size() * 7, 0.f), scratch(backward_scratch(1)), out;
    grad[std::size_t(pixel)] = g;
    const Plane<const float> planes[2] = {{grad.data(), 1}, {}};
    const std::uint8_t moves[1] = {1};
    TileScratch<float> memory;
    kernels.backward(
        {work(), {value.data(), 1}, &background, planes, moves, pair.data(), scratch.data(), &memory.tape});
    for (std::size_t i = 0; i < record.size(); ++i) out.push_back(pair[i * 7 + 5]);
    return out;
  }

 private:
  TileWork<float> work() {
    index_.resize(record.size());
    std::iota(index_.begin(), index_.end(), 0u);
    return {
        frame, record.data(), index_.data(), index_.data(), std::uint32_t(record.size()), float(kTransmittanceStop)};
  }
  std::vector<std::uint32_t> index_;
};

/// Reference of one pixel in long double. `ambiguous`: a threshold is so close that float may decide differently.
struct ReferencePixel {
  struct Hit {
    std::size_t index;
    Real alpha, before, condition;  // condition: of alpha
    bool capped;
  };
  std::vector<Hit> hit;
  Real channel = 0, transmittance = 1, channel_spread = 0, transmittance_condition = 1;
  bool ambiguous = false;

  ReferencePixel(const Stack& s, int pixel) {
    const Real x = s.frame.x_px + pixel % kTilePx + 0.5L, y = s.frame.y_px + pixel / kTilePx + 0.5L;
    for (std::size_t i = 0; i < s.record.size(); ++i) {
      const SplatRecord<float>& g = s.record[i];
      const Real u = g.mean_x - x, v = g.mean_y - y;
      const auto& [xx, xy, yy] = s.covariance[i];
      // The quadratic form as two squares: the rounding error is proportional to `along`, not to the squares of its
      // parts.
      const Real half_a = yy / (2 * (xx * yy - xy * xy)), part_u = std::sqrt(half_a) * u,
                 part_v = -std::sqrt(half_a) * xy / yy * v, along = part_u + part_v,
                 power = -along * along - v * v / (2 * yy);
      const Real size_x = std::abs(Real(g.mean_x) - s.frame.x_px) + 16,
                 size_y = std::abs(Real(g.mean_y) - s.frame.y_px) + 16;
      const Real opacity = s.opacity[i];
      const Real steep_x = std::sqrt(half_a), steep_y = steep_x * std::abs(xy) / yy;
      Real condition =
          2 - std::log(opacity) - power +
          2 * std::abs(along) * (std::abs(part_u) + std::abs(part_v) + steep_x * size_x + steep_y * size_y) +
          std::abs(v) / yy * size_y;
      const Real free = opacity * std::exp(power);
      const bool capped = free >= 0.99L;
      const Real alpha = capped ? Real(0.99f) : free;
      ambiguous |= std::abs(alpha * 255 - 1) < 1e-6L * condition || std::abs(free / 0.99L - 1) < 1e-6L * condition;
      if (alpha < 1 / 255.L) continue;
      const Real next = transmittance * (1 - alpha);
      ambiguous |= std::abs(next * 1e4L - 1) < 1e-6L * (transmittance_condition + condition * 100);
      if (next < 1e-4L) break;
      if (capped) condition = 1;
      hit.push_back({i, alpha, transmittance, condition, capped});
      channel += alpha * transmittance * s.value[i];
      channel_spread += alpha * transmittance * s.value[i] * (condition + transmittance_condition + 1);
      transmittance_condition += 1 + alpha / (1 - alpha) * condition;
      transmittance = next;
    }
  }
};

/// Compares channel and transmittance of some pixels with the reference, and the lane types with each other.
void check_stack(Stack& stack, Random& random, Worst& worst, int pixels) {
  const Stack::Image image = stack.composite(lane_types()[0]);
  for (const TileKernels<float>& kernels : lane_types()) worst.ours_is(stack.composite(kernels) == image);
  for (int k = 0; k < pixels; ++k) {
    const auto p = std::size_t(random.below(kTilePixels));
    const ReferencePixel want(stack, int(p));
    if (want.ambiguous) continue;
    worst.ours(image.transmittance[p], want.transmittance, want.transmittance_condition);
    if (want.channel > 0) worst.ours(image.channel[p], want.channel, want.channel_spread / want.channel);
    float sum = 0;
    for (const ReferencePixel::Hit& h : want.hit) sum += float(h.alpha * h.before);
    worst.naive(1 - sum, want.transmittance, want.transmittance_condition);
  }
}

}  // namespace

HARD_CASE("compositing: a pixel under many faint Gaussians keeps its transmittance", "Gaussians", {10, 100, 1000, 1e5},
          0.62, {"T as 1 - Σ w", 100}, 4) {
  Stack stack;
  for (int i = 0; i < int(h); ++i) stack.add_round(random, 200, float(random.uniform(0.005, 0.03)));
  check_stack(stack, random, worst, 20);
}

HARD_CASE("compositing: nearly opaque layers keep the accuracy of the transmittance", "opacity",
          {0.5, 0.9, 0.98, 0.9899}, 1.1, {"T as 1 - Σ w", 10}) {
  Stack stack;
  for (int i = 0; i < 2; ++i) stack.add_round(random, 500, float(h * random.uniform(0.99, 1)));
  for (int i = 0; i < 10; ++i) stack.add_round(random, 500, float(random.uniform(0.005, 0.02)));
  check_stack(stack, random, worst, 4);
}

TEST_CASE("compositing: needles reach exactly the right pixels, also thousands of pixels from their centre") {
  const auto printed = [](const Stack& stack, const ReferencePixel& pixel, int p) {  // Eq. (2) as printed
    float transmittance = 1;
    for (const ReferencePixel::Hit& hit : pixel.hit) {
      const auto& [xx, xy, yy] = stack.covariance[hit.index];
      const Real det = xx * yy - xy * xy;
      const float a = float(yy / det), b = float(-xy / det), c = float(xx / det);
      const float u = float(stack.record[hit.index].mean_x - (p % 16 + 0.5)),
                  v = float(stack.record[hit.index].mean_y - (p / 16 + 0.5));
      transmittance *=
          1 - std::min(0.99f, stack.opacity[hit.index] * std::exp(-0.5f * (a * u * u + c * v * v) - b * u * v));
    }
    return transmittance;
  };
  test::hard_case({"length, px", {1, 10, 100, 1e3, 1e4}, 1.2, {"a u² + 2 b u v + c v²", 1e5}},
                  [&](double h, Random& random, Worst& worst) {
                    Stack stack;
                    for (int i = 0; i < 6; ++i) {
                      const double phi = random.uniform(0, 6.28), c = std::cos(phi), s = std::sin(phi), major = h * h,
                                   minor = 0.36, off = random.uniform(-1.5, 1.5) * h, across = random.uniform(-1, 1);
                      stack.add(8 + off * c - across * s, 8 + off * s + across * c, major * c * c + minor * s * s,
                                (major - minor) * c * s, major * s * s + minor * c * c, float(random.uniform(0.1, 0.9)),
                                float(random.uniform(0.1, 1)));
                    }
                    check_stack(stack, random, worst, 0);
                    const Stack::Image image = stack.composite(lane_types()[0]);
                    for (int k = 0; k < 16; ++k) {
                      const auto p = std::size_t(random.below(kTilePixels));
                      const ReferencePixel want(stack, int(p));
                      if (want.ambiguous || want.hit.empty()) continue;
                      worst.ours(image.transmittance[p], want.transmittance, want.transmittance_condition);
                      worst.ours(image.channel[p], want.channel, want.channel_spread / want.channel);
                      worst.naive(printed(stack, want, int(p)), want.transmittance, want.transmittance_condition);
                    }
                  });
}

HARD_CASE("compositing: far to the right of a wide image positions keep their sub-pixel part", "column, px",
          {16, 1024, 16384, 65520}, 0.3, {"mean and pixel in float", 200}) {
  Stack stack;
  stack.frame = {int(h), 0, int(h) + 16, 16};
  for (int i = 0; i < 4; ++i) stack.add_round(random, 1.5, float(random.uniform(0.3, 0.9)));
  check_stack(stack, random, worst, 0);
  const auto [channel, transmittance] = stack.composite(lane_types().back());
  for (int k = 0; k < 8; ++k) {
    const auto p = std::size_t(random.below(kTilePixels));
    const ReferencePixel want(stack, int(p));
    if (want.ambiguous || want.hit.empty()) continue;
    worst.ours(transmittance[p], want.transmittance, want.transmittance_condition);
    float naive = 1;
    for (const ReferencePixel::Hit& hit : want.hit) {
      const SplatRecord<float>& g = stack.record[hit.index];
      const float u = float(g.mean_x) - (float(stack.frame.x_px + int(p) % 16) + 0.5f),
                  v = float(g.mean_y) - (float(stack.frame.y_px + int(p) / 16) + 0.5f);
      naive *=
          1 - std::min(0.99f, stack.opacity[hit.index] * std::exp(-0.5f * (g.form.a() * u * u + g.form.c() * v * v)));
    }
    worst.naive(naive, want.transmittance, want.transmittance_condition);
  }
}

HARD_CASE("compositing: opacity gradients keep their accuracy deep in a stack, gathered from back to front", "opacity",
          {0.1, 0.5, 0.9, 0.985}, 0.18, {"T from 1 - alpha of the image, divided by 1 - α", 3}) {
  Stack stack;
  for (int i = 0; i < 2; ++i) stack.add_round(random, 300, float(h * random.uniform(0.95, 1)));
  for (int i = 0; i < 20; ++i) stack.add_round(random, 300, float(random.uniform(0.01, 0.1)));
  const int p = int(random.below(kTilePixels));
  const float g = float(random.uniform(0.5, 1)), background = 0.3f;
  const std::vector<float> got = stack.opacity_gradients(lane_types().back(), p, g, background);
  for (const TileKernels<float>& kernels : lane_types()) {  // one lane and eight sum the pixels in different orders
    const std::vector<float> other = stack.opacity_gradients(kernels, p, g, background);
    for (std::size_t i = 0; i < got.size(); ++i) worst.ours(other[i], got[i]);
  }
  const ReferencePixel want(stack, p);
  if (want.ambiguous) return;
  float naive_after = 1 - float(1 - want.transmittance), naive_behind = naive_after * background;
  Real behind = want.transmittance * background;  // colour behind times transmittance
  for (std::size_t k = want.hit.size(); k-- > 0;) {
    const ReferencePixel::Hit& hit = want.hit[k];
    const Real value = stack.value[hit.index], after = hit.before * (1 - hit.alpha);
    const Real factor = g * hit.alpha * hit.before, own = value, rest = behind / after;
    const Real size = factor * (own + rest) * (hit.condition + want.transmittance_condition);
    worst.ours(got[hit.index], factor * (own - rest), size / std::abs(factor * (own - rest)));
    const float alpha = float(hit.alpha), before = naive_after / (1 - alpha);
    worst.naive(g * alpha * (before * float(value) - naive_behind / (1 - alpha)), factor * (own - rest),
                size / std::abs(factor * (own - rest)));
    naive_behind += alpha * before * float(value);
    naive_after = before;
    behind += hit.alpha * hit.before * value;
  }
}

HARD_CASE("compositing: at the cap alpha is 0.99 and passes no gradient to the opacity", "opacity", {0.9, 0.995, 1}, 0,
          {"g α (T c - behind / (1 - α)) of an α without a cap", test::kWrong}) {
  Stack stack;
  stack.add(8.5, 8.5, 1e6, 0, 1e6, float(h), 0.7f);
  const int p = int(random.below(kTilePixels));
  const auto [channel, transmittance] = stack.composite(lane_types().back());
  const float background = 0.3f, gradient = stack.opacity_gradients(lane_types().back(), p, 1, background)[0];
  const bool capped = h > 0.99;
  const double u = 8 - p % kTilePx, v = 8 - p / kTilePx, alpha = h * std::exp(-(u * u + v * v) / 2e6);
  const double want = capped ? 0 : alpha * (0.7 - 0.3);
  const auto as_wanted = [&](float g) { return std::abs(g - want) <= 1e-5 * want; };
  worst.ours_is(!capped || transmittance[std::size_t(p)] == 1 - 0.99f ||
                transmittance[std::size_t(p)] == std::fma(-0.99f, 1.f, 1.f));
  worst.ours_is(as_wanted(gradient));
  const float a = float(alpha), behind = (1 - a) * background;
  worst.naive_is(as_wanted(a * (stack.value[0] - behind / (1 - a))));
}

HARD_CASE("compositing: behind many opaque Gaussians a pixel stops before its transmittance underflows", "Gaussians",
          {1, 3, 30, 3000}, 0, {"Π (1 - α) to the end", test::kWrong}) {
  Stack stack;
  float naive = 1;
  for (int i = 0; i < int(h); ++i) {
    stack.add_round(random, 500, float(random.uniform(0.9, 1)));
    naive *= 1 - std::min(0.99f, stack.opacity.back());
  }
  const auto [channel, transmittance] = stack.composite(lane_types().back());
  for (std::size_t p = 0; p < kTilePixels; ++p)
    worst.ours_is(transmittance[p] >= 1e-4f && transmittance[p] <= 0.11f && channel[p] <= 1);
  worst.naive_is(naive > 0);
}

HARD_CASE("compositing: alpha below 1/255 adds exactly nothing, alpha from 1/255 on contributes", "opacity · 255",
          {1.1, 1, 0.9999, 1e-30}, 0, "not applicable: a rule, not a formula") {
  Stack stack;
  stack.add(8.5, 8.5, 1, 0, 1, float(kAlphaMin), 1);
  const float opacity = h == 1 ? float(kAlphaMin) : float(h / 255);
  stack.record[0].max_mahalanobis2 = std::max(0.f, 2 * std::log(255 * opacity));
  stack.record[0].log2_opacity = float(std::log2(double(opacity)));
  const auto [channel, transmittance] = stack.composite(lane_types().back());
  const auto centre = std::size_t(8 * 16 + 8), other = std::size_t(random.below(kTilePixels));
  worst.ours_is((channel[centre] > 0) == (h >= 1) && (transmittance[centre] < 1) == (h >= 1));
  if (h < 1) worst.ours_is(channel[other] == 0 && transmittance[other] == 1);
}

HARD_CASE("compositing: equal depths are composited in index order", "Gaussians", {2, 17, 100}, 0,
          "not applicable: an order by depth alone may give any image") {
  GaussianCloud cloud;
  cloud.resize(int(h), 0);
  for (std::size_t i = 0; i < std::size_t(h); ++i) {
    cloud.position[i * 3] = float(random.uniform(-0.2, 0.2));
    cloud.position[i * 3 + 1] = float(random.uniform(-0.2, 0.2));
    cloud.position[i * 3 + 2] = 3;
    cloud.rotation[i * 4] = 1;
    for (std::size_t k = 0; k < 3; ++k) cloud.log_scale[i * 3 + k] = -2;
  }
  const Camera camera = test::camera_along_z(32, 32, 32);
  for (const int threads : {1, 3}) {
    const TileLists lists =
        bin_tiles({.threads = threads}, project_view({}, cloud_view(cloud, 0, nullptr), camera, {}), 32, 32);
    for (std::size_t tile = 0; tile < std::size_t(lists.tiles()); ++tile)
      worst.ours_is(std::is_sorted(lists.visible.begin() + lists.tile_begin[tile],
                                   lists.visible.begin() + lists.tile_begin[tile + 1]));
  }
}

HARD_CASE("compositing: a needle is listed in every tile that it intersects", "length, world", {0.1, 1, 10, 100}, 0,
          {"half extents from the conic, divided by a c - b² in float", test::kWrong}) {
  GaussianCloud cloud;
  cloud.resize(1, 0);
  const double length = h * random.uniform(0.5, 1);
  for (std::size_t k = 0; k < 3; ++k) {
    cloud.position[k] = float(random.uniform(-0.5, 0.5)) + (k == 2 ? 3.f : 0.f);
    cloud.log_scale[k] = float(std::log(k == 0 ? length : 1e-3));
  }
  for (float& q : cloud.rotation) q = float(random.uniform(-1, 1));
  cloud.logit_opacity[0] = 2;
  const Camera camera = test::camera_along_z(128, 128, 128);
  const auto view = project_view({}, cloud_view(cloud, 0, nullptr), camera, {});
  if (view.id.empty()) return;
  const SplatRecord<float>& g = view.record[0];
  const TileLists lists = bin_tiles({}, view, 128, 128);
  bool listed[64] = {}, reached[64] = {};
  for (std::size_t tile = 0; tile < 64; ++tile) listed[tile] = lists.tile_begin[tile] < lists.tile_begin[tile + 1];
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 128; ++x) {
      const double u = g.mean_x - (x + 0.5), v = g.mean_y - (y + 0.5);
      const double form = double(g.form.a()) * u * u + 2 * double(g.form.b()) * u * v + double(g.form.c()) * v * v;
      if (form < double(g.max_mahalanobis2) * (1 - 1e-4)) reached[y / 16 * 8 + x / 16] = true;
    }
  const TileRect r = view.rect[0];
  const float a = g.form.a(), b = g.form.b(), c = g.form.c(), det = a * c - b * b,
              half = std::sqrt(g.max_mahalanobis2 * c / det);
  for (int tile = 0; tile < 64; ++tile) {
    const int tx = tile % 8, ty = tile / 8;
    if (tx < r.x_begin || tx >= r.x_end || ty < r.y_begin || ty >= r.y_end || !reached[tile]) continue;
    worst.ours_is(listed[tile]);
    worst.naive_is(tx * 16 <= g.mean_x + double(half) && tx * 16 + 16 >= g.mean_x - double(half));
  }
}

}  // namespace ngs
