#pragma once
// The two gradient checks used in tests/grad.
//
// Adjoint test: <u, J v> = <Jᵀ u, v>. J v comes from the forward kernel run on dual numbers, Jᵀ u from the
// backward kernel. Both are exact up to rounding: no step size to tune.
// Ridders test: the same directional derivative by extrapolated central differences, which shares no code
// with Dual, so a wrong Dual cannot hide a wrong kernel.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "ngs/math/dual.h"

namespace ngs::test {

using DualD = Dual<double>;

/// x + ε v.
inline std::vector<DualD> seed(const std::vector<double>& x, const std::vector<double>& v) {
  std::vector<DualD> d(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) d[i] = {x[i], v[i]};
  return d;
}
inline std::vector<double> value(const std::vector<DualD>& d) {
  std::vector<double> r;
  for (const DualD& a : d) r.push_back(a.v);
  return r;
}
inline std::vector<double> deriv(const std::vector<DualD>& d) {
  std::vector<double> r;
  for (const DualD& a : d) r.push_back(a.d);
  return r;
}
template <class T>
std::vector<T> constant(const std::vector<double>& x) {
  return std::vector<T>(x.begin(), x.end());
}

inline double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double s = 0;
  for (std::size_t i = 0; i < a.size(); ++i) s += a[i] * b[i];
  return s;
}

/// |a - b| relative to the larger of the two; 0 if both are 0.
inline double relative_difference(double a, double b) {
  const double scale = std::max(std::abs(a), std::abs(b));
  return scale == 0 ? 0 : std::abs(a - b) / scale;
}

/// The relative difference of the two sides of an adjoint test, or of a gradient and extrapolated differences. With
/// NGS_GRAD_TABLE set, the worst value of each op (the test name up to its colon) is printed at the end of the run.
/// `scale`: the size of the terms if both sides are sums with cancellation.
double adjoint_difference(double jv, double jtu, double scale = 0);
double ridders_difference(double numeric, double gradient);

/// d/dt f(t) at 0 by Ridders' extrapolation of central differences. `f` must be smooth on [-step, step].
template <class F>
double ridders(const F& f, double step) {
  constexpr int kLevels = 8;
  constexpr double kShrink = 1.6;
  double table[kLevels][kLevels], best = 0, best_error = INFINITY;
  for (int i = 0; i < kLevels; ++i, step /= kShrink) {
    table[0][i] = (f(step) - f(-step)) / (2 * step);
    double factor = kShrink * kShrink;
    for (int j = 1; j <= i; ++j, factor *= kShrink * kShrink) {
      table[j][i] = (table[j - 1][i] * factor - table[j - 1][i - 1]) / (factor - 1);
      const double error =
          std::max(std::abs(table[j][i] - table[j - 1][i]), std::abs(table[j][i] - table[j - 1][i - 1]));
      if (error <= best_error) {
        best_error = error;
        best = table[j][i];
      }
    }
  }
  return best;
}

/// x + t v.
inline std::vector<double> moved(std::vector<double> x, const std::vector<double>& v, double t) {
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += t * v[i];
  return x;
}

}  // namespace ngs::test
