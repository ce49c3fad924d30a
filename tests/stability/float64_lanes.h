#pragma once
// Replaces math/lanes.h in the double build (float64.sh): a pack is 8 doubles with the operations of PackF. Pack4D is
// copied unchanged.
#include <immintrin.h>

#include <cmath>
#include <cstdint>

#include "ngs/math/dual.h"
#include "ngs/math/lane_scalar.h"

namespace ngs {

struct PackF {
  static constexpr int kLanes = 8;
  typedef double Raw __attribute__((vector_size(64)));
  typedef std::int64_t RawMask __attribute__((vector_size(64)));
  Raw v;

  PackF() = default;
  PackF(Raw raw) : v(raw) {}
  PackF(double x) : v(Raw{x, x, x, x, x, x, x, x}) {}
  friend PackF operator+(PackF a, PackF b) { return a.v + b.v; }
  friend PackF operator-(PackF a, PackF b) { return a.v - b.v; }
  friend PackF operator*(PackF a, PackF b) { return a.v * b.v; }
  friend PackF operator/(PackF a, PackF b) { return a.v / b.v; }
  friend PackF operator-(PackF a) { return -a.v; }
  PackF& operator+=(PackF b) {
    v += b.v;
    return *this;
  }
};

struct PackMask {
  PackF::RawMask v;
  friend PackMask operator&(PackMask a, PackMask b) { return {a.v & b.v}; }
  friend PackMask operator|(PackMask a, PackMask b) { return {a.v | b.v}; }
  friend PackMask operator!(PackMask a) { return {~a.v}; }
};
inline PackMask operator<(PackF a, PackF b) { return {a.v < b.v}; }
inline PackMask operator<=(PackF a, PackF b) { return {a.v <= b.v}; }
inline PackMask operator>=(PackF a, PackF b) { return {a.v >= b.v}; }
inline PackMask operator>(PackF a, PackF b) { return {a.v > b.v}; }
inline PackMask and_at_least(PackMask m, PackF a, PackF b) { return m & (a >= b); }

template <>
struct LaneTraits<PackF> {
  using Scalar = double;
  using Folded = PackF;
  using Mask = PackMask;
  static constexpr int kLanes = PackF::kLanes;
};

inline PackF each_lane(PackF x, auto&& f) {
  for (int i = 0; i < PackF::kLanes; ++i) x.v[i] = f(i);
  return x;
}
inline int count_lanes(PackMask m) {
  int n = 0;
  for (int i = 0; i < PackF::kLanes; ++i) n += m.v[i] != 0;
  return n;
}
inline bool any(PackMask m) { return count_lanes(m) > 0; }
inline PackF select(PackMask m, PackF a, PackF b) { return m.v ? a.v : b.v; }
inline PackF fma_lanes(PackF a, PackF b, PackF c) {
  return each_lane(c, [&](int i) { return std::fma(a.v[i], b.v[i], c.v[i]); });
}
inline PackF min_lanes(PackF a, PackF b) { return a.v < b.v ? a.v : b.v; }
inline PackF max_lanes(PackF a, PackF b) { return a.v > b.v ? a.v : b.v; }
inline PackF sqrt_lanes(PackF x) {
  return each_lane(x, [&](int i) { return std::sqrt(x.v[i]); });
}
inline PackF floor_lanes(PackF x) {
  return each_lane(x, [&](int i) { return std::floor(x.v[i]); });
}
inline void store_row_bits(std::uint32_t* p, PackF begin, PackF end) {
  for (int i = 0; i < PackF::kLanes; ++i) store_row_bits(p + i, begin.v[i], end.v[i]);
}
inline void store_lanes(double* p, PackF x) {
  for (int i = 0; i < PackF::kLanes; ++i) p[i] = x.v[i];
}
inline void load_lanes(const double* p, PackF& x) {
  for (int i = 0; i < PackF::kLanes; ++i) x.v[i] = p[i];
}
inline void iota_lanes(double start, PackF& x) {
  x = each_lane(x, [&](int i) { return start + i; });
}
inline double sum_lanes(PackF x) {
  return ((x.v[0] + x.v[4]) + (x.v[2] + x.v[6])) + ((x.v[1] + x.v[5]) + (x.v[3] + x.v[7]));
}
inline void sum_lanes_each(const PackF* x, int n, double* out) {
  for (int i = 0; i < n; ++i) out[i] = sum_lanes(x[i]);
}
inline PackF folded(PackF x) { return x; }
inline PackMask all_lanes(PackF) { return {PackF::RawMask{-1, -1, -1, -1, -1, -1, -1, -1}}; }
inline PackF exp2_where(PackMask m, PackF x) {
  return each_lane(x, [&](int i) { return m.v[i] ? std::exp2(x.v[i]) : 0.0; });
}

struct HalfPack {
  PackF v;
  HalfPack() = default;
  explicit HalfPack(PackF x) : v(x) {}
  PackF wide() const { return v; }
};

template <class T>
Dual<T> fma_lanes(Dual<T> a, Dual<T> b, Dual<T> c) {
  return a * b + c;
}
template <class T>
Dual<T> exp2_where(bool m, Dual<T> x) {
  return m ? exp2(x) : Dual<T>(0);
}

}  // namespace ngs
