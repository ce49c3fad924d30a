#pragma once
// The colour regulariser of the authors' released code, with what is odd about it.        PAPER.md §6.5
//
// A network refines the constant colours of at most 4096 Gaussians: 8 hash levels of 2 features, looked up at
// the floor cell without interpolation, in coordinates renormalised by the minimum and maximum of each batch,
// with composite "primes"; two layers, one modulation by the colour itself, rgb = clamp(base + 0.1 tanh). Its
// output only ever meets the loss below: no ray, no pixel and no mask takes part. In double, for a gradient
// that can be tested.
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
  const std::vector<double>& base;     // [M, 3] their colours, in [0, 1]
};

struct ReleasedLosses {
  double align = 0, continuity = 0, smooth = 0, density = 0, total = 0;
};

class ReleasedField {
 public:
  explicit ReleasedField(std::uint64_t seed);

  /// Losses of M Gaussians and their gradients: `grad_base` [M, 3] and grad() are overwritten. `draw` numbers the step,
  /// for its jitter. Gradients stop where the code detaches.
  ReleasedLosses evaluate(const Exec& exec, const ReleasedWeights& weights, const ReleasedRows& in, std::uint64_t draw,
                          std::vector<double>& grad_base);
  /// One Adam step of the network and its tables against grad().
  void step(const Exec& exec, double lr);

  std::vector<double>& parameters() { return value_; }
  const std::vector<double>& grad() const { return grad_; }

 private:
  std::vector<double> value_, grad_, m_, v_;
  std::uint64_t seed_;
  std::int64_t steps_ = 0;
};

}  // namespace ngs
