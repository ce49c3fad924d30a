#pragma once
// What the masks of all views say about each Gaussian. Additive: the evidence of a set of views is the exact sum
// of its parts, in any order and any sharding, so that merged partial runs equal one run byte for byte.
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/math/exact_sum.h"

namespace ngs {

/// The evidence of a single view, of the V Gaussians with W > 0.
struct ViewSums {
  int objects = 0;
  std::vector<std::uint32_t> row;  // [V] increasing
  std::vector<double> sum;         // [V, 2 + 2 K] W, pixels, then W1 <= W and pixels of each object

  std::size_t size() const { return row.size(); }
  int columns() const { return 2 + 2 * objects; }
  const double* at(std::size_t v) const { return &sum[v * std::size_t(columns())]; }
  double weight(std::size_t v) const { return at(v)[0]; }
  double object_weight(std::size_t v, std::size_t k) const { return at(v)[2 + 2 * k]; }
};

/// N Gaussians, K objects; [N, K] row-major. w = α T is a Gaussian's weight at a pixel, M the mask there.
struct Evidence {
  std::int64_t gaussians = 0;
  int objects = 0;
  ExactSums weight;                          // [N]    W  = Σ_views Σ_pixels w          over known pixels
  ExactSums object_weight;                   // [N, K] W1 = Σ_views Σ_pixels w M
  std::vector<std::uint64_t> pixels;         // [N]    known pixels reached (unweighted)
  std::vector<std::uint64_t> object_pixels;  // [N, K] of these, with M >= 0.5
  std::vector<std::uint32_t> views;          // [N]    views with W > 0
  // Per-view signals m = W1 / W of one view, quantised to 2^-32; their sum and the sum of their squares.
  std::vector<std::uint64_t> signal_sum;  // [N, K] in units of 2^-32
  ExactSums signal_square_sum;            // [N, K]
  // Per-view r = |n₊ - n₋| / (n₊ + n₋) of the unweighted counts (COB-GS), quantised to 2^-32.
  std::vector<std::uint64_t> contrast_sum;  // [N, K] in units of 2^-32

  Evidence() = default;
  Evidence(std::int64_t n, int k);
  void add(const Evidence& other);
  /// What one view says of a Gaussian: a row of ViewSums.
  void add(std::size_t gaussian, const double* sum);
  /// The signal m in [0, 1] of one view, [N, K] cell. m² is kept as the exact square of the quantised m: as a double
  /// it could fall short of it, and the variance of equal signals below zero.
  void add_signal(std::size_t cell, double m);
};

/// 4 · variance over views of the signal, in [0, 1], from the exact sums: V Σ m² - (Σ m)² is evaluated in integers,
/// where the textbook difference cannot cancel.
double between_views_variance(const Evidence& evidence, std::size_t row, std::uint32_t views);

}  // namespace ngs
