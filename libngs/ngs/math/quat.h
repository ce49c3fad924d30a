#pragma once
// Rotation matrices of quaternions (w, x, y, z), with their adjoints.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>

#include "ngs/math/vec.h"

namespace ngs {

/// Unit quaternion of q; the zero quaternion means the identity. `inv_norm` is 0 in that case (no gradient).
/// Scaled by the largest component first: q of any finite size neither overflows nor underflows.
template <class T>
NGS_HD Vec4<T> normalised(Vec4<T> q, T& inv_norm) {
  using std::sqrt;
  const auto magnitude = [](T x) { return x < T(0) ? -x : x; };
  T largest = magnitude(q.x);
  for (const T c : {magnitude(q.y), magnitude(q.z), magnitude(q.w)})
    if (largest < c) largest = c;
  if (!(largest > T(0))) {
    inv_norm = T(0);
    return {T(1), T(0), T(0), T(0)};
  }
  const Vec4<T> s{q.x / largest, q.y / largest, q.z / largest, q.w / largest};
  const T inv = T(1) / sqrt(s.x * s.x + s.y * s.y + s.z * s.z + s.w * s.w);
  inv_norm = inv / largest;
  return {s.x * inv, s.y * inv, s.z * inv, s.w * inv};
}

/// ∂L/∂q from ∂L/∂(unit quaternion): (g - (g·u) u) / |q|.
template <class T>
NGS_HD Vec4<T> normalised_backward(Vec4<T> unit, T inv_norm, Vec4<T> g) {
  const T along = g.x * unit.x + g.y * unit.y + g.z * unit.z + g.w * unit.w;
  return {(g.x - along * unit.x) * inv_norm, (g.y - along * unit.y) * inv_norm, (g.z - along * unit.z) * inv_norm,
          (g.w - along * unit.w) * inv_norm};
}

/// Members of Vec4 hold (w, x, y, z) in this order, as the PLY does.
template <class T>
NGS_HD Mat3<T> rotation_matrix(Vec4<T> q) {
  const T w = q.x, x = q.y, y = q.z, z = q.w;
  const T two(2);
  return {{T(1) - two * (y * y + z * z), two * (x * y - w * z), two * (x * z + w * y), two * (x * y + w * z),
           T(1) - two * (x * x + z * z), two * (y * z - w * x), two * (x * z - w * y), two * (y * z + w * x),
           T(1) - two * (x * x + y * y)}};
}

/// The axes of a Gaussian, as columns, from its stored quaternion (w, x, y, z) of any length.
inline Mat3<double> axes_of_quaternion(const float* q) {
  double inv_norm = 0;
  return rotation_matrix(normalised(Vec4<double>{double(q[0]), double(q[1]), double(q[2]), double(q[3])}, inv_norm));
}

/// The unit quaternion of a rotation matrix, by its largest component (Shepperd's method).
inline Vec4<double> quaternion_of(const Mat3<double>& r) {
  const std::array<double, 4> squared{1 + r(0, 0) + r(1, 1) + r(2, 2), 1 + r(0, 0) - r(1, 1) - r(2, 2),
                                      1 - r(0, 0) + r(1, 1) - r(2, 2), 1 - r(0, 0) - r(1, 1) + r(2, 2)};
  const auto largest = std::size_t(std::max_element(squared.begin(), squared.end()) - squared.begin());
  const double x = r(2, 1) - r(1, 2), y = r(0, 2) - r(2, 0), z = r(1, 0) - r(0, 1);
  const double xy = r(1, 0) + r(0, 1), xz = r(2, 0) + r(0, 2), yz = r(2, 1) + r(1, 2);
  std::array<double, 4> q{};
  switch (largest) {
    case 0: q = {squared[0], x, y, z}; break;
    case 1: q = {x, squared[1], xy, xz}; break;
    case 2: q = {y, xy, squared[2], yz}; break;
    default: q = {z, xz, yz, squared[3]}; break;
  }
  double norm = 0;
  for (const double c : q) norm += c * c;
  for (double& c : q) c /= std::sqrt(norm);
  return {q[0], q[1], q[2], q[3]};
}

/// The same as stored in a model.
inline std::array<float, 4> stored_quaternion(const Mat3<double>& rotation) {
  const Vec4<double> q = quaternion_of(rotation);
  return {float(q.x), float(q.y), float(q.z), float(q.w)};
}

/// ∂L/∂(unit quaternion) from ∂L/∂(rotation matrix).
template <class T>
NGS_HD Vec4<T> rotation_matrix_backward(Vec4<T> q, const Mat3<T>& g) {
  const T w = q.x, x = q.y, y = q.z, z = q.w;
  const T two(2);
  return {two * (x * (g(2, 1) - g(1, 2)) + y * (g(0, 2) - g(2, 0)) + z * (g(1, 0) - g(0, 1))),
          two * (y * (g(0, 1) + g(1, 0)) + z * (g(0, 2) + g(2, 0)) + w * (g(2, 1) - g(1, 2)) -
                 two * x * (g(1, 1) + g(2, 2))),
          two * (x * (g(0, 1) + g(1, 0)) + z * (g(1, 2) + g(2, 1)) + w * (g(0, 2) - g(2, 0)) -
                 two * y * (g(0, 0) + g(2, 2))),
          two * (x * (g(0, 2) + g(2, 0)) + y * (g(1, 2) + g(2, 1)) + w * (g(1, 0) - g(0, 1)) -
                 two * z * (g(0, 0) + g(1, 1)))};
}

}  // namespace ngs
