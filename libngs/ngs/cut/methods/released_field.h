#pragma once
// The colour regulariser of the authors' released code, oddities included.                 paper.md §6.5
//
// A network refines the constant (SH degree 0) colours of at most 4096 Gaussians. Its 8 hash levels of 2 features are
// looked up at the floor cell without interpolation, with composite numbers in place of primes, in coordinates
// normalised by the minimum and maximum of each batch. Two layers follow, with one modulation by the colour itself:
// rgb = clamp(base + 0.1 tanh). The output is used only in the losses below; no ray, pixel or mask takes part.
// Arithmetic is in double, so that tests can check the gradient.
#include <cstdint>
#include <vector>

#include "ngs/backend/exec.h"

namespace ngs {

struct ReleasedWeights {
  double align = 1, continuity = 0.1, smooth = 0.05, density = 1e-3;
};

/// The Gaussians of a batch.
struct ReleasedRows {
  const std::vector<float>& position;  // [M, 3] world
  const std::vector<double>& base;     // [M, 3] colours in [0, 1]
};

struct ReleasedLosses {
  double align = 0, continuity = 0, smooth = 0, density = 0, total = 0;
};

class ReleasedField {
 public:
  explicit ReleasedField(std::uint64_t seed);

  /// Losses of M Gaussians and their gradients. Overwrites `grad_base` [M, 3] and grad(). `draw` is the number of the
  /// step, the jitter's random counter. Gradients stop where the published code detaches.
  ReleasedLosses evaluate(const Exec& exec, const ReleasedWeights& weights, const ReleasedRows& in, std::uint64_t draw,
                          std::vector<double>& grad_base);
  /// One Adam step of the network and the hash tables along grad().
  void step(const Exec& exec, double lr);

  std::vector<double>& parameters() { return value_; }
  const std::vector<double>& grad() const { return grad_; }

 private:
  std::vector<double> value_, grad_, m_, v_;
  std::uint64_t seed_;
  std::int64_t steps_ = 0;
};

}  // namespace ngs
