#pragma once
// Scalar maths of rays and depth windows.                                                  Eqs. (6)-(7)
#include <cmath>

#include "ngs/core/hd.h"
#include "ngs/math/stable.h"
#include "ngs/math/vec.h"

namespace ngs {

/// The unit direction, in world axes, of the ray through pixel position (u, v).                 Eq. (6)
///
///   d = Rᵀ normalise((u - cx) / fx, (v - cy) / fy, 1),   R: world -> camera
///
/// The paper calls R camera -> world but transposes it; with R world -> camera the formula is right
/// (C11). `cosine` is the angle's with the optical axis: z-depth = cosine · distance along the ray.
template <class T>
NGS_HD Vec3<T> ray_direction(const Mat3<T>& rotation, T fx, T fy, T cx, T cy, T u, T v, T& cosine) {
  using std::sqrt;
  const T x = (u - cx) / fx, y = (v - cy) / fy;
  cosine = T(1) / sqrt(x * x + y * y + T(1));
  return cosine * (transpose(rotation) * Vec3<T>{x, y, T(1)});
}

/// The part of a ray that is sampled: distances from the camera centre, 0 < near <= far.
template <class T>
struct DepthWindow {
  T near, far;
};

/// [t - h, t + h] with h = max(span·t, epsilon), cut where it would reach the camera.           Eq. (7)
template <class T>
NGS_HD DepthWindow<T> depth_window(T centre, T span, T epsilon, T nearest) {
  const T half = max2(span * centre, epsilon);
  return {max2(centre - half, nearest), max2(centre + half, nearest)};
}

/// Distance of sample k of K: near to far inclusive, δ_k = -1 + 2k / (K - 1); K = 1: the middle (C9).
template <class T>
NGS_HD T sample_distance(DepthWindow<T> window, int k, int samples) {
  if (samples == 1) return T(0.5) * (window.near + window.far);
  const T t = T(k) / T(samples - 1);
  return (T(1) - t) * window.near + t * window.far;
}

/// The length of ray that one sample stands for in Eq. (1) (C15).
template <class T>
NGS_HD T sample_spacing(DepthWindow<T> window, int samples) {
  return (window.far - window.near) / T(samples > 1 ? samples - 1 : 1);
}

}  // namespace ngs
