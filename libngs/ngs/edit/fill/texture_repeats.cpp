#include "ngs/edit/fill/texture_repeats.h"

#include <algorithm>
#include <cmath>

#include "ngs/backend/for_each.h"
#include "ngs/scene/geometry/surface_points.h"

namespace ngs {
namespace {

using Size = std::size_t;

constexpr double kMaxPairs = 3e8;   // maximum number of compared pairs; above it, texels are subsampled
constexpr double kMinPairs = 0.12;  // minimum share of the compared texels that have a partner at an offset
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

/// The offsets at which texels are alike, the best first, in both directions.
std::vector<Offset> alike_offsets(const Exec& exec, const TextureGrid& grid) {
  std::vector<std::int64_t> known, compared;
  for (Size i = 0; i < grid.state.size(); ++i)
    if (grid.state[i] == Texel::kKnown) known.push_back(std::int64_t(i));
  if (known.empty()) return {};
  const std::int64_t width = 2 * grid.columns - 1;
  const double most = kMaxPairs / double(width * grid.rows);
  for (const Size k : orbit::thinned(known.size(), Size(std::max(most, 1.0)))) compared.push_back(known[k]);
  double squares = 0, sum[3] = {0, 0, 0};
  for (const std::int64_t i : known)
    for (Size c = 0; c < 3; ++c) {
      const auto x = double(grid.colour[3 * Size(i) + c]);
      squares += x * x;
      sum[c] += x;
    }
  for (const double s : sum) squares -= s * s / double(known.size());
  const double unrelated = 2 * squares / double(known.size());  // expected squared difference of two unrelated texels
  std::vector<double> likeness(Size(width * grid.rows));
  for_each_index(exec, std::int64_t(likeness.size()), [&](std::int64_t k) {
    const std::int64_t dx = k % width - grid.columns + 1, dy = k / width;
    double difference = 0, pairs = 0;
    for (const std::int64_t i : compared) {
      if (!is_known(grid, i % grid.columns + dx, i / grid.columns + dy)) continue;
      difference += squared_difference(grid, i, i + dy * grid.columns + dx);
      ++pairs;
    }
    if (pairs >= std::max(kLeastPairs, kMinPairs * double(compared.size())) && unrelated > 0)
      likeness[Size(k)] = 1 - difference / (pairs * unrelated);
  });
  std::vector<Offset> offsets;
  for (Size k = 0; k < likeness.size(); ++k) {
    const std::int64_t dx = std::int64_t(k) % width - grid.columns + 1, dy = std::int64_t(k) / width;
    if (likeness[k] < kMinLikeness || (dy == 0 && dx <= 0)) continue;
    offsets.push_back({likeness[k], dx, dy});
    offsets.push_back({likeness[k], -dx, -dy});
  }
  std::ranges::stable_sort(offsets, std::ranges::greater{}, &Offset::likeness);
  return offsets;
}

}  // namespace

Repeats find_repeats(const Exec& exec, const TextureGrid& grid) {
  const std::vector<Offset> offsets = alike_offsets(exec, grid);
  Repeats out{std::vector<float>(grid.colour.size()), std::vector<float>(grid.state.size())};
  for_each_index(exec, std::int64_t(grid.state.size()), [&](std::int64_t i) {
    if (grid.state[Size(i)] != Texel::kUnknown) return;
    double sum[3] = {0, 0, 0}, weights = 0;
    int count = 0;
    for (const Offset& o : offsets) {
      if (count == kMeanOf) break;
      if (!is_known(grid, i % grid.columns + o.x, i / grid.columns + o.y)) continue;
      const double weight = o.likeness / (1 - o.likeness + kEqual);
      const float* colour = &grid.colour[3 * Size(i + o.y * grid.columns + o.x)];
      for (Size c = 0; c < 3; ++c) sum[c] += weight * double(colour[c]);
      weights += weight;
      ++count;
      if (count == 1) out.likeness[Size(i)] = float(o.likeness);  // the best offset comes first
    }
    for (Size c = 0; count > 0 && c < 3; ++c) out.colour[3 * Size(i) + c] = float(sum[c] / weights);
  });
  return out;
}

}  // namespace ngs
