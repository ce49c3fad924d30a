#pragma once
// Random draws of one recipe, numbered in order of use: the layout of a scene is a function of its seed.
#include <cmath>
#include <cstdint>
#include <numbers>

#include "ngs/core/rng.h"
#include "ngs/math/vec.h"

namespace ngs::synth {

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : seed_(seed) {}
  /// In [low, high).
  double uniform(double low, double high) {
    return low + (high - low) * rng_uniform(seed_, RngStream::kSynth, next_++);
  }
  /// One of 0 to count - 1.
  int index(int count) { return int(uniform(0, count)); }

 private:
  std::uint64_t seed_, next_ = 0;
};

/// A saturated colour of any hue, each channel in [0, 1].
inline Vec3<double> bright(Dice& dice) {
  const double hue = dice.uniform(0, 2 * std::numbers::pi), lift = dice.uniform(0.5, 0.6);
  const double third = 2 * std::numbers::pi / 3;
  return {lift + 0.35 * std::cos(hue), lift + 0.35 * std::cos(hue - third), lift + 0.35 * std::cos(hue + third)};
}

}  // namespace ngs::synth
