#pragma once
// Small fixed-size algebra, templated on the scalar (float, double, long double, Dual, SIMD pack).
#include <cmath>

#include "ngs/core/hd.h"

namespace ngs {

template <class T>
struct Vec2 {
  T x, y;
};
template <class T>
struct Vec3 {
  T x, y, z;
};
template <class T>
struct Vec4 {
  T x, y, z, w;
};

template <class T>
NGS_HD Vec3<T> operator+(Vec3<T> a, Vec3<T> b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
NGS_HD Vec3<T> operator-(Vec3<T> a, Vec3<T> b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
NGS_HD Vec3<T> operator*(T s, Vec3<T> a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class T>
NGS_HD T dot(Vec3<T> a, Vec3<T> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
NGS_HD Vec3<T> cross(Vec3<T> a, Vec3<T> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(Vec3<double> v) { return std::sqrt(dot(v, v)); }
/// v / |v|; +z for the zero vector.
inline Vec3<double> unit(Vec3<double> v) {
  const double n = length(v);
  return n > 0 ? (1 / n) * v : Vec3<double>{0, 0, 1};
}
template <class T>
NGS_HD Vec3<T> vec3(const T* p) {
  return {p[0], p[1], p[2]};
}

/// Row-major 3x3.
template <class T>
struct Mat3 {
  T m[9];
  NGS_HD T operator()(int r, int c) const { return m[r * 3 + c]; }
  NGS_HD T& operator()(int r, int c) { return m[r * 3 + c]; }
};

template <class T>
NGS_HD Vec3<T> operator*(const Mat3<T>& a, Vec3<T> v) {
  return {a.m[0] * v.x + a.m[1] * v.y + a.m[2] * v.z, a.m[3] * v.x + a.m[4] * v.y + a.m[5] * v.z,
          a.m[6] * v.x + a.m[7] * v.y + a.m[8] * v.z};
}
template <class T>
NGS_HD Mat3<T> operator*(const Mat3<T>& a, const Mat3<T>& b) {
  Mat3<T> r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r(i, j) = a(i, 0) * b(0, j) + a(i, 1) * b(1, j) + a(i, 2) * b(2, j);
  return r;
}
template <class T>
NGS_HD Mat3<T> transpose(const Mat3<T>& a) {
  return {{a.m[0], a.m[3], a.m[6], a.m[1], a.m[4], a.m[7], a.m[2], a.m[5], a.m[8]}};
}
template <class To, class From>
NGS_HD Mat3<To> mat3_cast(const Mat3<From>& a) {
  Mat3<To> r;
  for (int i = 0; i < 9; ++i) r.m[i] = To(a.m[i]);
  return r;
}

}  // namespace ngs
