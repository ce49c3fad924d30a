#include "ngs/edit/fill/cast_shadow.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ngs/backend/for_each.h"
#include "ngs/math/median.h"
#include "ngs/math/sh.h"

namespace ngs {
namespace {

using orbit::Vec;

constexpr std::int64_t kBlocksAcross = 56;      // blocks (squares of cells) along the longer side of the grid
constexpr std::int64_t kGap = 3, kWideGap = 5;  // blocks between compared blocks: to find the light; to measure depth
constexpr int kLights = 1600, kConeSides = 8, kLightRounds = 4;
constexpr double kLightTurn = 0.1;    // rad: first refinement
constexpr double kLowestLight = 0.3;  // sine of elevation; a lower light casts shadows beyond the known surroundings
constexpr double kMinPairs = 16;
constexpr double kMinShadowFactor = 0.2;  // lower bound on CastShadow::shadow_factor
constexpr double kMinScore = 5.5;         // measured: 6.0 to 8.6 with a shadow, at most 5.0 without one, 5.8 in clutter
constexpr double kMinDarker = 0.8;        // minimum share of pairs whose block in the shadow is darker
constexpr double kHalfShadow = 0.12;      // rad: angular radius of the light; large, because a splat blurs outlines
constexpr double kDarkFrom = 0.35;        // lit fraction up to which a point is in full shadow, for the same reason
constexpr double kContactRing = 0.04;     // diagonals: width of the contact shadow around the hole, which is excluded

struct Block {
  Vec place;
  double level = 0;  // logarithm of the mean colour
  bool known = false;
};

struct Blocks {
  std::int64_t columns = 0, rows = 0;
  std::vector<Block> block;
};

Blocks blocks_of(const HoleScene& scene, const FillSurface& surface, const HoleCells& cells) {
  std::vector<std::uint8_t> ring(cells.state.size());
  for (std::size_t i = 0; i < ring.size(); ++i) ring[i] = cells.state[i] == HoleCell::kHole;
  ring = dilated(cells, std::move(ring), int(kContactRing * scene.rim.diagonal / cells.side));
  const std::int64_t side = std::max<std::int64_t>(1, std::max(cells.columns, cells.rows) / kBlocksAcross);
  Blocks blocks{cells.columns / side, cells.rows / side, {}};
  for (std::int64_t k = 0; k < blocks.columns * blocks.rows; ++k) {
    const std::int64_t x = k % blocks.columns * side, y = k / blocks.columns * side;
    double sum = 0;
    bool known = true;
    for (std::int64_t c = 0; c < side * side; ++c) {
      const auto cell = std::size_t((y + c / side) * cells.columns + x + c % side);
      known = known && cells.state[cell] == HoleCell::kCovered && !ring[cell];
      for (std::size_t a = 0; a < 3; ++a) sum += std::max(0.0, colour_of_dc(double(cells.colour[3 * cell + a])));
    }
    const double half = 0.5 * double(side) * cells.side;
    const Vec2<double> low = cells.centre(y * cells.columns + x);
    const double u = low.x + half - 0.5 * cells.side, v = low.y + half - 0.5 * cells.side;
    const double mean = sum / double(3 * side * side);
    blocks.block.push_back({surface.point(u, v, 0), std::log(std::max(mean, 1e-3)), known && mean > 1e-3});
  }
  return blocks;
}

struct Darkness {
  Vec light{0, 0, 1};
  double score = 0, shadow_factor = 1;
};

/// Compares blocks inside the predicted shadow of one light with blocks outside of it, across the shadow's outline.
Darkness darkness_of(const HoleScene& scene, const Blocks& blocks, Vec light, std::int64_t gap) {
  std::vector<std::uint8_t> hidden(blocks.block.size());
  for (std::size_t k = 0; k < hidden.size(); ++k)
    hidden[k] = blocks.block[k].known && scene.occluder.hides(blocks.block[k].place, light);
  std::vector<double> ratio;
  double darker = 0;
  const auto compare = [&](std::size_t a, std::size_t b) {
    const Block &one = blocks.block[a], &other = blocks.block[b];
    if (!one.known || !other.known || hidden[a] == hidden[b]) return;
    const double d = hidden[a] ? one.level - other.level : other.level - one.level;
    ratio.push_back(d);
    darker += d < 0;
  };
  for (std::int64_t y = 0; y < blocks.rows; ++y)
    for (std::int64_t x = 0; x < blocks.columns; ++x) {
      const auto k = std::size_t(y * blocks.columns + x);
      if (x + gap < blocks.columns) compare(k, k + std::size_t(gap));
      if (y + gap < blocks.rows) compare(k, k + std::size_t(gap * blocks.columns));
    }
  const auto pairs = double(ratio.size());
  if (pairs < kMinPairs || darker < kMinDarker * pairs) return {light, 0, 1};
  const double middle = upper_median(std::move(ratio));
  return {light, -middle * std::sqrt(pairs), std::exp(middle)};
}

/// The darkest of several lights; of equal ones the first.
Darkness darkest(const Exec& exec, const HoleScene& scene, const Blocks& blocks, const std::vector<Vec>& lights) {
  std::vector<Darkness> found(lights.size());
  for_each_task(exec, std::int64_t(lights.size()), [&](std::int64_t k) {
    found[std::size_t(k)] = darkness_of(scene, blocks, lights[std::size_t(k)], kGap);
  });
  return found.empty() ? Darkness{} : *std::ranges::max_element(found, {}, &Darkness::score);
}

/// Directions on a circle of `radius` rad around `axis`, and `axis`.
std::vector<Vec> cone(Vec axis, double radius, int count) {
  const Vec a = orbit::perpendicular(axis), b = cross(axis, a);
  std::vector<Vec> directions{axis};
  for (int k = 0; k < count; ++k) {
    const double angle = 2 * std::numbers::pi * k / count;
    directions.push_back(unit(axis + radius * (std::cos(angle) * a + std::sin(angle) * b)));
  }
  return directions;
}

}  // namespace

double CastShadow::at(const Occluder& occluder, Vec p) const {
  if (shadow_factor >= 1) return 1;
  double lit = 0, all = 0;
  for (const double radius : {0.5 * kHalfShadow, kHalfShadow})
    for (const Vec& direction : cone(light, radius, kConeSides)) {
      ++all;
      lit += !occluder.hides(p, direction);
    }
  return shadow_factor + (1 - shadow_factor) * std::max(0.0, (lit / all - kDarkFrom) / (1 - kDarkFrom));
}

CastShadow find_cast_shadow(const Exec& exec, const HoleScene& scene, std::size_t index, const HoleCells& cells) {
  const FillSurface& surface = scene.surfaces[index];
  const Blocks blocks = blocks_of(scene, surface, cells);
  std::vector<Vec> lights;
  for (const Vec& d : orbit::even_directions(kLights))
    if (dot(d, surface.normal) >= kLowestLight) lights.push_back(d);
  Darkness best = darkest(exec, scene, blocks, lights);
  for (int k = 0; k < kLightRounds && best.score > 0; ++k)
    best = darkest(exec, scene, blocks, cone(best.light, kLightTurn / double(1 << k), kConeSides));
  if (best.score < kMinScore) return {};
  const Darkness wide = darkness_of(scene, blocks, best.light, kWideGap);
  best.shadow_factor = std::min(best.shadow_factor, wide.shadow_factor);
  return {best.light, std::max(best.shadow_factor, kMinShadowFactor)};
}

}  // namespace ngs
