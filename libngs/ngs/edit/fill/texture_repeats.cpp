#include "ngs/edit/fill/texture_repeats.h"

#include <algorithm>
#include <cmath>

#include "ngs/backend/for_each.h"
#include "ngs/scene/geometry/surface_points.h"

namespace ngs {
namespace {

using Size = std::size_t;

constexpr double kMaxPairs = 3e8;   // above, fewer texels are compared with those at every offset
constexpr double kMinPairs = 0.12;  // of the compared texels, at an offset, and at least
constexpr double kLeastPairs = 24;
constexpr double kMinLikeness = 0.3;
constexpr double kEqual = 0.03;  // likenesses above 1 less this count about the same
constexpr int kMeanOf = 32;

struct Offset {
  double likeness;
  std::int64_t x, y;
};

bool is_known(const TextureGrid& grid, std::int64_t x, std::int64_t y) {
  return x >= 0 && y >= 0 && x < grid.columns && y < grid.rows &&
         grid.state[Size(y * grid.columns + x)] == Texel::kKnown;
}

double squared_difference(const TextureGrid& grid, std::int64_t a, std::int64_t b) {
  double sum = 0;
  for (Size c = 0; c < 3; ++c) {
    const double d = double(grid.colour[3 * Size(a) + c]) - double(grid.colour[3 * Size(b) + c]);
    sum += d * d;
  }
  return sum;
}

/// Twice the variance of the colours, summed over the channels: the mean squared difference of unrelated texels.
double unrelated_difference(const TextureGrid& grid, const std::vector<std::int64_t>& known) {
  double twice = 0;
  for (Size c = 0; c < 3; ++c) {
    double sum = 0, squares = 0;
    for (const std::int64_t i : known) {
      const auto x = double(grid.colour[3 * Size(i) + c]);
      sum += x, squares += x * x;
    }
    const double mean = sum / double(known.size());
    twice += 2 * std::max(0.0, squares / double(known.size()) - mean * mean);
  }
  return twice;
}

/// The offsets at which texels are alike, the best first, in both directions.
std::vector<Offset> alike_offsets(const Exec& exec, const TextureGrid& grid) {
  std::vector<std::int64_t> known, compared;
  for (Size i = 0; i < grid.state.size(); ++i)
    if (grid.state[i] == Texel::kKnown) known.push_back(std::int64_t(i));
  if (known.empty()) return {};
  const std::int64_t width = 2 * grid.columns - 1;
  const double most = kMaxPairs / double(width * grid.rows);
  for (const Size k : orbit::thinned(known.size(), Size(std::max(most, 1.0)))) compared.push_back(known[k]);
  const double unrelated = unrelated_difference(grid, known);
  std::vector<double> likeness(Size(width * grid.rows));
  for_each_index(exec, std::int64_t(likeness.size()), [&](std::int64_t k) {
    const std::int64_t dx = k % width - grid.columns + 1, dy = k / width;
    double sum = 0, pairs = 0;
    for (const std::int64_t i : compared) {
      if (!is_known(grid, i % grid.columns + dx, i / grid.columns + dy)) continue;
      sum += squared_difference(grid, i, i + dy * grid.columns + dx), ++pairs;
    }
    if (pairs >= std::max(kLeastPairs, kMinPairs * double(compared.size())) && unrelated > 0)
      likeness[Size(k)] = 1 - sum / (pairs * unrelated);
  });
  std::vector<Offset> offsets;
  for (Size k = 0; k < likeness.size(); ++k) {
    const std::int64_t dx = std::int64_t(k) % width - grid.columns + 1, dy = std::int64_t(k) / width;
    if (likeness[k] < kMinLikeness || (dy == 0 && dx <= 0)) continue;
    offsets.push_back({likeness[k], dx, dy}), offsets.push_back({likeness[k], -dx, -dy});
  }
  std::ranges::stable_sort(offsets, std::ranges::greater{}, &Offset::likeness);
  return offsets;
}

}  // namespace

double fill_by_repeats(const Exec& exec, TextureGrid& grid) {
  const std::vector<Offset> offsets = alike_offsets(exec, grid);
  const TextureGrid from = grid;
  std::vector<double> best(grid.state.size());
  for_each_index(exec, std::int64_t(grid.state.size()), [&](std::int64_t i) {
    if (from.state[Size(i)] != Texel::kUnknown) return;
    double sum[3] = {0, 0, 0}, weights = 0;
    int count = 0;
    for (const Offset& o : offsets) {
      if (count == kMeanOf) break;
      if (!is_known(from, i % from.columns + o.x, i / from.columns + o.y)) continue;
      const double weight = o.likeness / (1 - o.likeness + kEqual);
      const float* colour = &from.colour[3 * Size(i + o.y * from.columns + o.x)];
      for (Size c = 0; c < 3; ++c) sum[c] += weight * double(colour[c]);
      weights += weight, best[Size(i)] = std::max(best[Size(i)], o.likeness), ++count;
    }
    if (count == 0) return;
    for (Size c = 0; c < 3; ++c) grid.colour[3 * Size(i) + c] = float(sum[c] / weights);
    grid.state[Size(i)] = Texel::kKnown;
  });
  double sum = 0;
  for (const double likeness : best) sum += likeness;
  return sum / std::max(1.0, double(std::ranges::count(from.state, Texel::kUnknown)));
}

}  // namespace ngs
