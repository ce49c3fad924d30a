#pragma once
// Counter-based random numbers: (seed, stream, index) -> number. The same bits on every platform, thread
// count and device; no state to pass on or to save in a checkpoint.
#include <cmath>
#include <cstdint>

#include "ngs/core/hd.h"

namespace ngs {

/// Named streams: two uses of one seed never draw the same numbers.
enum class RngStream : std::uint32_t {
  kHashInit,
  kMlpInit,
  kFeatureInit,
  kViewOrder,
  kSmoothJitter,
  kSplit,
  kSynth,
  kMaskNoise,
  kFitInit,
  kTest,
  kSaga,
  kReleased,
  kFill,
  kTiles
};

/// 64 well-mixed bits (the finaliser of SplitMix64, applied twice).
NGS_HD inline std::uint64_t rng_bits(std::uint64_t seed, RngStream stream, std::uint64_t index) {
  std::uint64_t z = seed * 0x9E3779B97F4A7C15ull + (std::uint64_t(stream) + 1) * 0xD1B54A32D192ED03ull;
  for (int round = 0; round < 2; ++round) {
    z += index * 0x9E3779B97F4A7C15ull + 0x9E3779B97F4A7C15ull;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    z ^= z >> 31;
  }
  return z;
}

/// Uniform in [0, 1), 53 bits.
NGS_HD inline double rng_uniform(std::uint64_t seed, RngStream stream, std::uint64_t index) {
  return double(rng_bits(seed, stream, index) >> 11) * 0x1.0p-53;
}

/// Uniform on the unit sphere, from the numbers 2·index and 2·index + 1.
NGS_HD inline void rng_unit_vector(std::uint64_t seed, RngStream stream, std::uint64_t index, double (&xyz)[3]) {
  const double z = 2 * rng_uniform(seed, stream, 2 * index) - 1;
  const double angle = 6.283185307179586 * rng_uniform(seed, stream, 2 * index + 1);
  const double radius = std::sqrt(1 - z * z);
  xyz[0] = radius * std::cos(angle);
  xyz[1] = radius * std::sin(angle);
  xyz[2] = z;
}

/// Standard normal (Box-Muller on the numbers 2·index and 2·index + 1).
inline double rng_normal(std::uint64_t seed, RngStream stream, std::uint64_t index) {
  const double u = 1.0 - rng_uniform(seed, stream, 2 * index);  // (0, 1]
  const double v = rng_uniform(seed, stream, 2 * index + 1);
  return std::sqrt(-2.0 * std::log(u)) * std::cos(6.283185307179586 * v);
}

}  // namespace ngs
