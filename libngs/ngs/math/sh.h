#pragma once
// Real spherical harmonics up to degree 3 in the sign convention of 3DGS.
#include "ngs/math/vec.h"

namespace ngs {

inline constexpr double kShC0 = 0.28209479177387814;
inline constexpr double kShC1 = 0.4886025119029199;
/// The colour of a Gaussian without view dependence, from its coefficient of the constant band; and the inverse.
template <class T>
NGS_HD constexpr T colour_of_dc(T dc) {
  return T(0.5) + T(kShC0) * dc;
}
template <class T>
NGS_HD constexpr T dc_of_colour(T colour) {
  return (colour - T(0.5)) / T(kShC0);
}
/// Factors of the second and third band. Functions, because device code cannot read a host array.
NGS_HD constexpr double sh_c2(int k) {
  constexpr double kFactor[5] = {1.0925484305920792, -1.0925484305920792, 0.31539156525252005, -1.0925484305920792,
                                 0.5462742152960396};
  return kFactor[k];
}
NGS_HD constexpr double sh_c3(int k) {
  constexpr double kFactor[7] = {-0.5900435899266435, 2.890611442640554, -0.4570457994644658, 0.3731763325901154,
                                 -0.4570457994644658, 1.445305721320277, -0.5900435899266435};
  return kFactor[k];
}

/// The basis functions beyond the constant one at the unit direction d: basis[0 .. (degree + 1)² - 2].
template <class T>
NGS_HD void sh_rest_basis(int degree, Vec3<T> d, T* basis) {
  if (degree < 1) return;
  const T x = d.x, y = d.y, z = d.z;
  basis[0] = T(-kShC1) * y;
  basis[1] = T(kShC1) * z;
  basis[2] = T(-kShC1) * x;
  if (degree < 2) return;
  const T xx = x * x, yy = y * y, zz = z * z;
  basis[3] = T(sh_c2(0)) * (x * y);
  basis[4] = T(sh_c2(1)) * (y * z);
  basis[5] = T(sh_c2(2)) * (T(2) * zz - xx - yy);
  basis[6] = T(sh_c2(3)) * (x * z);
  basis[7] = T(sh_c2(4)) * (xx - yy);
  if (degree < 3) return;
  basis[8] = T(sh_c3(0)) * y * (T(3) * xx - yy);
  basis[9] = T(sh_c3(1)) * (x * y) * z;
  basis[10] = T(sh_c3(2)) * y * (T(4) * zz - xx - yy);
  basis[11] = T(sh_c3(3)) * z * (T(2) * zz - T(3) * xx - T(3) * yy);
  basis[12] = T(sh_c3(4)) * x * (T(4) * zz - xx - yy);
  basis[13] = T(sh_c3(5)) * z * (xx - yy);
  basis[14] = T(sh_c3(6)) * x * (xx - T(3) * yy);
}

/// Σ_k g[k] ∂basis[k]/∂d: the gradient with respect to the (unit) direction, components taken as independent.
template <class T>
NGS_HD Vec3<T> sh_rest_basis_backward(int degree, Vec3<T> d, const T* g) {
  Vec3<T> r{T(0), T(0), T(0)};
  if (degree < 1) return r;
  const T x = d.x, y = d.y, z = d.z;
  r = {T(-kShC1) * g[2], T(-kShC1) * g[0], T(kShC1) * g[1]};
  if (degree < 2) return r;
  const T c2[5] = {T(sh_c2(0)) * g[3], T(sh_c2(1)) * g[4], T(sh_c2(2)) * g[5], T(sh_c2(3)) * g[6], T(sh_c2(4)) * g[7]};
  const T two(2), three(3), four(4), six(6), eight(8);
  r.x += c2[0] * y - two * c2[2] * x + c2[3] * z + two * c2[4] * x;
  r.y += c2[0] * x + c2[1] * z - two * c2[2] * y - two * c2[4] * y;
  r.z += c2[1] * y + four * c2[2] * z + c2[3] * x;
  if (degree < 3) return r;
  T c3[7];
  for (int k = 0; k < 7; ++k) c3[k] = T(sh_c3(k)) * g[8 + k];
  const T xx = x * x, yy = y * y, zz = z * z;
  r.x += c3[0] * six * (x * y) + c3[1] * (y * z) - c3[2] * two * (x * y) - c3[3] * six * (x * z) +
         c3[4] * (four * zz - three * xx - yy) + c3[5] * two * (x * z) + c3[6] * three * (xx - yy);
  r.y += c3[0] * three * (xx - yy) + c3[1] * (x * z) + c3[2] * (four * zz - xx - three * yy) - c3[3] * six * (y * z) -
         c3[4] * two * (x * y) - c3[5] * two * (y * z) - c3[6] * six * (x * y);
  r.z += c3[1] * (x * y) + c3[2] * eight * (y * z) + c3[3] * (six * zz - three * xx - three * yy) +
         c3[4] * eight * (x * z) + c3[5] * (xx - yy);
  return r;
}

}  // namespace ngs
