#pragma once
// Forward-mode dual number a + b·ε with ε² = 0. The scalar of the gradient tests: J·v of any kernel, exact
// to rounding. Comparisons look at the value only.
#include <cmath>
#include <numbers>

#include "ngs/core/hd.h"

namespace ngs {

template <class T>
struct Dual {
  T v{};  // value
  T d{};  // directional derivative
  Dual() = default;
  Dual(T value, T deriv = T(0)) : v(value), d(deriv) {}
  explicit operator double() const { return double(v); }

  friend Dual operator+(Dual a, Dual b) { return {a.v + b.v, a.d + b.d}; }
  friend Dual operator-(Dual a, Dual b) { return {a.v - b.v, a.d - b.d}; }
  friend Dual operator-(Dual a) { return {-a.v, -a.d}; }
  friend Dual operator*(Dual a, Dual b) { return {a.v * b.v, a.d * b.v + a.v * b.d}; }
  friend Dual operator/(Dual a, Dual b) { return {a.v / b.v, (a.d - a.v / b.v * b.d) / b.v}; }
  Dual& operator+=(Dual o) { return *this = *this + o; }
  Dual& operator-=(Dual o) { return *this = *this - o; }
  Dual& operator*=(Dual o) { return *this = *this * o; }
  Dual& operator/=(Dual o) { return *this = *this / o; }
  friend bool operator<(Dual a, Dual b) { return a.v < b.v; }
  friend bool operator>(Dual a, Dual b) { return a.v > b.v; }
  friend bool operator<=(Dual a, Dual b) { return a.v <= b.v; }
  friend bool operator>=(Dual a, Dual b) { return a.v >= b.v; }
  friend bool operator==(Dual a, Dual b) { return a.v == b.v; }

  friend Dual exp(Dual a) {
    const T e = std::exp(a.v);
    return {e, e * a.d};
  }
  friend Dual exp2(Dual a) {
    const T e = std::exp2(a.v);
    return {e, e * T(std::numbers::ln2) * a.d};
  }
  friend Dual expm1(Dual a) { return {std::expm1(a.v), std::exp(a.v) * a.d}; }
  friend Dual log2(Dual a) { return {std::log2(a.v), a.d / (a.v * T(std::numbers::ln2))}; }
  friend Dual log(Dual a) { return {std::log(a.v), a.d / a.v}; }
  friend Dual log1p(Dual a) { return {std::log1p(a.v), a.d / (T(1) + a.v)}; }
  friend Dual sqrt(Dual a) {
    const T s = std::sqrt(a.v);
    return {s, a.d / (T(2) * s)};
  }
  friend Dual tanh(Dual a) {
    const T t = std::tanh(a.v);
    return {t, (T(1) - t * t) * a.d};
  }
  friend Dual sin(Dual a) { return {std::sin(a.v), std::cos(a.v) * a.d}; }
  friend Dual cos(Dual a) { return {std::cos(a.v), -std::sin(a.v) * a.d}; }
  friend Dual abs(Dual a) { return a.v < T(0) ? -a : a; }
  friend Dual floor(Dual a) { return {std::floor(a.v), T(0)}; }
  friend bool isfinite(Dual a) { return std::isfinite(a.v) && std::isfinite(a.d); }
};

}  // namespace ngs
