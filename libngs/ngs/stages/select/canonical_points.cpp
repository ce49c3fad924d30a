#include "ngs/stages/select/canonical_points.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "ngs/core/check.h"

namespace ngs {
namespace {

/// The finaliser of SplitMix64 over the bits of a position.
std::uint64_t hash_of(const float* position) {
  std::uint64_t hash = 0;
  for (int axis = 0; axis < 3; ++axis) {
    hash += std::bit_cast<std::uint32_t>(position[axis] + 0.f) + 0x9E3779B97F4A7C15ull;  // -0 is 0
    hash = (hash ^ (hash >> 30)) * 0xBF58476D1CE4E5B9ull;
    hash = (hash ^ (hash >> 27)) * 0x94D049BB133111EBull;
    hash ^= hash >> 31;
  }
  return hash;
}

template <class T>
std::vector<T> permuted(const std::vector<T>& values, const std::vector<std::uint32_t>& order) {
  std::vector<T> out;
  out.reserve(order.size());
  for (const std::uint32_t i : order) out.push_back(values[i]);
  return out;
}

}  // namespace

orbit::SurfacePoints canonical_points(const GaussianCloud& cloud, const std::vector<std::uint8_t>& member) {
  NGS_CHECK(member.empty() || std::int64_t(member.size()) == cloud.size(), "one entry per Gaussian");
  const orbit::SurfacePoints all = orbit::surface_points(cloud);
  std::vector<std::uint64_t> hash(all.count());
  std::vector<std::uint32_t> order;
  for (std::size_t i = 0; i < all.count(); ++i) {
    hash[i] = hash_of(&cloud.position[3 * std::size_t(all.row[i])]);
    if (member.empty() || member[all.row[i]]) order.push_back(std::uint32_t(i));
  }
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (hash[a] != hash[b]) return hash[a] < hash[b];
    if (all.opacity[a] != all.opacity[b]) return all.opacity[a] < all.opacity[b];
    return all.area[a] < all.area[b];
  });
  return {permuted(all.row, order), permuted(all.position, order), permuted(all.opacity, order),
          permuted(all.size, order), permuted(all.area, order)};
}

}  // namespace ngs
