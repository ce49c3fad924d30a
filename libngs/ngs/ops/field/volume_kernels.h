#pragma once
// Quadrature of the volume rendering integral along one ray.                         Eq. (1); C15
//
//   τ_k = σ_k Δ,  T_k = exp(-Σ_{m<k} τ_m),  w_k = T_k (1 - e^{-τ_k})
//   C = Σ w_k c_k + e^{-D} background,   α = 1 - e^{-D},   D = Σ τ_k
#include <cmath>
#include <cstdint>

#include "ngs/core/hd.h"
#include "ngs/math/stable.h"
#include "ngs/math/vec.h"
#include "ngs/scene/views.h"

namespace ngs {

/// Inputs of forward and backward.
template <class T>
struct VolumeRays {
  std::int64_t rays;
  int samples;       // K, near to far
  const T* density;  // [R, K]     world^-1, >= 0
  const T* rgb;      // [R, K, 3]
  const T* spacing;  // [R]        Δ, world, >= 0
  Vec3<T> background;
};

/// Index r writes ray r. `1 - e^{-τ}` by expm1: as a difference it, and its gradient, would be 0 for τ < 6e-8.
template <class T>
struct VolumeForward {
  static constexpr const char* kName = "volume_forward";
  VolumeRays<T> in;
  T* colour;               // [R, 3] out, background included
  T* alpha;                // [R]    out
  T* optical_depth;        // [R]    out, D
  T* weight;               // [R, K] out, w_k, for backward
  T* transmittance_after;  // [R, K] out, T_{k+1}, for backward

  NGS_HD void operator()(std::int64_t r) const {
    T depth = T(0), transmittance = T(1);
    Vec3<T> sum{T(0), T(0), T(0)};
    for (int k = 0; k < in.samples; ++k) {
      const std::int64_t at = r * in.samples + k;
      const T tau = in.density[at] * in.spacing[r];
      weight[at] = transmittance * one_minus_exp(tau);
      sum = sum + weight[at] * vec3(in.rgb + at * 3);
      depth += tau;
      transmittance = exp_of(-depth);
      transmittance_after[at] = transmittance;
    }
    sum = sum + transmittance * in.background;
    colour[r * 3] = sum.x;
    colour[r * 3 + 1] = sum.y;
    colour[r * 3 + 2] = sum.z;
    alpha[r] = one_minus_exp(depth);
    optical_depth[r] = depth;
  }
};

/// Adjoint of VolumeForward. Index r writes ray r.
///
///   ∂C/∂τ_k = T_{k+1} c_k - S_k,   S_k = Σ_{m>k} w_m c_m + e^{-D} background   (colour behind sample k)
///   ∂α/∂τ_k = e^{-D},   ∂D/∂τ_k = 1,   ∂C/∂c_k = w_k
///
/// S is summed from back to front; no division by 1 - α, which is 0 for an opaque sample.
template <class T>
struct VolumeBackward {
  static constexpr const char* kName = "volume_backward";
  VolumeRays<T> in;
  const T* weight;               // [R, K] from VolumeForward
  const T* transmittance_after;  // [R, K] from VolumeForward
  const T* grad_colour;          // [R, 3]
  const T* grad_alpha;           // [R]
  const T* grad_optical_depth;   // [R], may be null: zero
  T* grad_density;               // [R, K]    out, overwritten
  T* grad_rgb;                   // [R, K, 3] out, overwritten

  NGS_HD void operator()(std::int64_t r) const {
    if (in.samples == 0) return;
    const Vec3<T> g = vec3(grad_colour + r * 3);
    const T end = transmittance_after[r * in.samples + in.samples - 1];
    const T common = grad_alpha[r] * end + (grad_optical_depth ? grad_optical_depth[r] : T(0));
    T behind = end * dot(g, in.background);
    for (int k = in.samples - 1; k >= 0; --k) {
      const std::int64_t at = r * in.samples + k;
      const T along = dot(g, vec3(in.rgb + at * 3));
      grad_density[at] = in.spacing[r] * (transmittance_after[at] * along - behind + common);
      behind += weight[at] * along;
      T* rgb = grad_rgb + at * 3;
      rgb[0] = weight[at] * g.x;
      rgb[1] = weight[at] * g.y;
      rgb[2] = weight[at] * g.z;
    }
  }
};

}  // namespace ngs
