#include "ngs/io/formats/morton.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace ngs::io {
namespace {

constexpr int kBits = 21;

/// Bit k of `v` at 3 k.
std::uint64_t spread(std::uint64_t v) {
  std::uint64_t bits = 0;
  for (int k = 0; k < kBits; ++k) bits |= (v >> k & 1) << (3 * k);
  return bits;
}

}  // namespace

SplatSelection along_morton_curve(const SplatSelection& model) {
  const std::vector<float>& position = model.cloud.position;
  std::array<float, 3> low, high;
  low.fill(INFINITY), high.fill(-INFINITY);
  for (const std::int64_t i : model.rows)
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], position[std::size_t(i) * 3 + a]);
      high[a] = std::max(high[a], position[std::size_t(i) * 3 + a]);
    }
  std::vector<std::uint64_t> code;
  for (const std::int64_t i : model.rows) {
    std::uint64_t bits = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double span = double(high[a]) - double(low[a]);
      const double share = span > 0 ? (double(position[std::size_t(i) * 3 + a]) - double(low[a])) / span : 0;
      bits |= spread(std::uint64_t(share * double((1 << kBits) - 1))) << a;
    }
    code.push_back(bits);
  }
  std::vector<std::size_t> order(code.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return code[a] < code[b]; });
  SplatSelection sorted{model.cloud, {}, model.left_out};
  for (const std::size_t k : order) sorted.rows.push_back(model.rows[k]);
  return sorted;
}

}  // namespace ngs::io
