#pragma once
// EWA projection of one Gaussian and its adjoint.                          Eq. (2); paper.md §5.1
#include <cmath>

#include "ngs/math/quat.h"
#include "ngs/math/sh.h"
#include "ngs/math/stable.h"
#include "ngs/math/vec.h"

namespace ngs {

/// The camera in the form that the projection needs.
///
// clang-format off
///   rotation     world -> camera
///   f_x, f_y, c_x, c_y        px, pixel centres at +0.5
///   x_lo, x_hi, y_lo, y_hi    limits of x/z and y/z inside the Jacobian: 0.15 image sizes beyond the border
///   near_z       Gaussians with z <= near_z are culled            world
///   blur         variance of the low-pass filter added to the projected covariance        px^2
///   antialiased  the opacity is multiplied by sqrt(det / det_blurred)
// clang-format on
template <class T>
struct ProjectionCamera {
  Mat3<T> rotation;
  T f_x, f_y, c_x, c_y;
  T x_lo, x_hi, y_lo, y_hi;
  T near_z, blur;
  bool antialiased;
};

inline constexpr double kCompensationFloor2 = 2.5e-5;  // of (det / blurred det): opacity factor >= 0.005

/// A Gaussian's shape and opacity in the encoding of GaussianCloud.
template <class T>
struct GaussianShape {
  const T *rotation, *log_scale;  // [4], [3]
  T logit_opacity;
};

/// A projected Gaussian.
///
// clang-format off
///   mean_x, mean_y      px
///   conic_a, _b, _c     inverse of the blurred 2D covariance [[a b] [b c]]                px^-2
///   cov_xx, cov_yy      diagonal of the blurred covariance                               px^2
///   det                 its determinant, > 0                                             px^4
///   opacity             sigmoid(logit) · compensation, in (0, 1]
// clang-format on
template <class T>
struct ProjectedGaussian {
  T mean_x, mean_y, conic_a, conic_b, conic_c, cov_xx, cov_yy, det, opacity;
};

/// Intermediate values of the projection. The backward pass recomputes them: cheaper than storing.
template <class T>
struct ProjectionContext {
  Vec4<T> unit_rotation;
  T inv_rotation_norm;
  Mat3<T> r, m;  // rotation of the Gaussian; r · diag(scale)
  Vec3<T> scale;
  T slope_x, slope_y;  // clamped x/z, y/z
  bool x_clamped, y_clamped;
  Vec3<T> u0, u1;   // rows of J · W
  Vec3<T> v0, v1;   // rows of J · W · R · S: covariance = [v_i · v_j]
  Vec3<T> v_cross;  // v0 × v1: its square is the determinant of the unblurred covariance
  T det_raw, compensation, logit_opacity;
  bool compensation_floored;
};

/// The view-independent part of the context: rotation, scale and their product.
template <class T>
NGS_HD void gaussian_shape(const T* rotation, const T* log_scale, ProjectionContext<T>& ctx) {
  ctx.unit_rotation = normalised(Vec4<T>{rotation[0], rotation[1], rotation[2], rotation[3]}, ctx.inv_rotation_norm);
  ctx.r = rotation_matrix(ctx.unit_rotation);
  ctx.scale = {exp_of(log_scale[0]), exp_of(log_scale[1]), exp_of(log_scale[2])};
  const T scale[3] = {ctx.scale.x, ctx.scale.y, ctx.scale.z};
  for (int i = 0; i < 9; ++i) ctx.m.m[i] = ctx.r.m[i] * scale[i % 3];
}

/// Projects a Gaussian whose centre is at `t` in camera coordinates, t.z > near_z.
///
/// The covariance is a Gram matrix V Vᵀ with V = J W R S, so it is never indefinite; its determinant is
/// |v0 × v1|² (Lagrange), which keeps full accuracy for needles where ac - b² cancels.
template <class T>
NGS_HD ProjectedGaussian<T> project_gaussian(const ProjectionCamera<T>& camera, Vec3<T> t,
                                             const GaussianShape<T>& shape, ProjectionContext<T>& ctx) {
  using std::sqrt;
  gaussian_shape(shape.rotation, shape.log_scale, ctx);

  const T slope_x = t.x / t.z, slope_y = t.y / t.z;
  ctx.slope_x = clamp3(slope_x, camera.x_lo, camera.x_hi);
  ctx.slope_y = clamp3(slope_y, camera.y_lo, camera.y_hi);
  ctx.x_clamped = slope_x < camera.x_lo || slope_x > camera.x_hi;
  ctx.y_clamped = slope_y < camera.y_lo || slope_y > camera.y_hi;
  const T j00 = camera.f_x / t.z, j11 = camera.f_y / t.z;
  const T j02 = -j00 * ctx.slope_x, j12 = -j11 * ctx.slope_y;
  const Vec3<T> w0 = vec3(camera.rotation.m), w1 = vec3(camera.rotation.m + 3), w2 = vec3(camera.rotation.m + 6);
  ctx.u0 = j00 * w0 + j02 * w2;
  ctx.u1 = j11 * w1 + j12 * w2;
  const Mat3<T> m_columns = transpose(ctx.m);
  ctx.v0 = m_columns * ctx.u0;
  ctx.v1 = m_columns * ctx.u1;

  const T a = dot(ctx.v0, ctx.v0), b = dot(ctx.v0, ctx.v1), c = dot(ctx.v1, ctx.v1);
  ctx.v_cross = cross(ctx.v0, ctx.v1);
  ctx.det_raw = dot(ctx.v_cross, ctx.v_cross);
  const T blur = camera.blur;
  ProjectedGaussian<T> p;
  p.cov_xx = a + blur;
  p.cov_yy = c + blur;
  p.det = ctx.det_raw + blur * (a + c) + blur * blur;
  p.conic_a = p.cov_yy / p.det;
  p.conic_b = -b / p.det;
  p.conic_c = p.cov_xx / p.det;
  p.mean_x = camera.f_x * slope_x + camera.c_x;
  p.mean_y = camera.f_y * slope_y + camera.c_y;

  ctx.logit_opacity = shape.logit_opacity;
  ctx.compensation = T(1);
  ctx.compensation_floored = true;
  if (camera.antialiased) {
    const T ratio = ctx.det_raw / p.det;
    ctx.compensation_floored = ratio < T(kCompensationFloor2);
    ctx.compensation = sqrt(max2(ratio, T(kCompensationFloor2)));
  }
  p.opacity = sigmoid(shape.logit_opacity) * ctx.compensation;
  return p;
}

/// ∂L/∂(result of project_gaussian); cov_xx, cov_yy and det carry no gradient of their own. For the opacity o it holds
/// o ∂L/∂o, which needs no division by o.
template <class T>
struct ProjectedGradient {
  T mean_x, mean_y, conic_a, conic_b, conic_c, log_opacity;
};

/// ∂L/∂(arguments of project_gaussian); `t` in camera coordinates.
template <class T>
struct GaussianGradient {
  Vec3<T> t;
  Vec4<T> rotation;
  Vec3<T> log_scale;
  T logit_opacity;
};

/// Adjoint of project_gaussian. With Q the conic and G its gradient (off-diagonal halved), the gradient with
/// respect to the blurred covariance is -Q G Q. Where the slope is clamped, J02 = -f s / z keeps only its
/// dependence on z (the true derivative; the reference 3DGS code differs here).
template <class T>
NGS_HD GaussianGradient<T> project_gaussian_backward(const ProjectionCamera<T>& camera, Vec3<T> t,
                                                     const ProjectedGaussian<T>& p, const ProjectionContext<T>& ctx,
                                                     const ProjectedGradient<T>& g) {
  const T half_b = g.conic_b / T(2);
  const T qa = p.conic_a, qb = p.conic_b, qc = p.conic_c;
  const T r00 = g.conic_a * qa + half_b * qb, r01 = g.conic_a * qb + half_b * qc;
  const T r10 = half_b * qa + g.conic_c * qb, r11 = half_b * qb + g.conic_c * qc;
  T grad_a = -(qa * r00 + qb * r10), grad_c = -(qb * r01 + qc * r11);
  const T grad_b = -T(2) * (qa * r01 + qb * r11);

  T grad_det_raw(0);
  if (camera.antialiased && !ctx.compensation_floored) {  // compensation² = det_raw / det
    const T grad_ratio = g.log_opacity / (T(2) * ctx.compensation * ctx.compensation);
    const T grad_det = -grad_ratio * (ctx.det_raw / p.det) / p.det;
    grad_det_raw = grad_ratio / p.det + grad_det;
    grad_a += camera.blur * grad_det;
    grad_c += camera.blur * grad_det;
  }
  const T two(2);
  const Vec3<T> grad_v0 = (two * grad_a) * ctx.v0 + grad_b * ctx.v1 + (two * grad_det_raw) * cross(ctx.v1, ctx.v_cross);
  const Vec3<T> grad_v1 = (two * grad_c) * ctx.v1 + grad_b * ctx.v0 + (two * grad_det_raw) * cross(ctx.v_cross, ctx.v0);

  GaussianGradient<T> out;
  const T u0[3] = {ctx.u0.x, ctx.u0.y, ctx.u0.z}, u1[3] = {ctx.u1.x, ctx.u1.y, ctx.u1.z};
  const T gv0[3] = {grad_v0.x, grad_v0.y, grad_v0.z}, gv1[3] = {grad_v1.x, grad_v1.y, grad_v1.z};
  const T scale[3] = {ctx.scale.x, ctx.scale.y, ctx.scale.z};
  Mat3<T> grad_r;
  T grad_log_scale[3] = {T(0), T(0), T(0)};
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) {
      const T grad_m = u0[i] * gv0[k] + u1[i] * gv1[k];  // V = U M
      grad_r(i, k) = grad_m * scale[k];
      grad_log_scale[k] += grad_m * ctx.m(i, k);
    }
  out.log_scale = {grad_log_scale[0], grad_log_scale[1], grad_log_scale[2]};
  out.rotation = normalised_backward(ctx.unit_rotation, ctx.inv_rotation_norm,
                                     rotation_matrix_backward(ctx.unit_rotation, grad_r));

  const Vec3<T> grad_u0 = ctx.m * grad_v0, grad_u1 = ctx.m * grad_v1;
  const Vec3<T> w0 = vec3(camera.rotation.m), w1 = vec3(camera.rotation.m + 3), w2 = vec3(camera.rotation.m + 6);
  const T grad_j00 = dot(grad_u0, w0), grad_j02 = dot(grad_u0, w2);
  const T grad_j11 = dot(grad_u1, w1), grad_j12 = dot(grad_u1, w2);
  const T fx_z = camera.f_x / t.z, fy_z = camera.f_y / t.z;
  const T slope_x = t.x / t.z, slope_y = t.y / t.z;
  // J02 = -(f/z) s: through 1/z always, through s = x/z only where it is not clamped.
  const T s_x = ctx.x_clamped ? T(0) : slope_x, s_y = ctx.y_clamped ? T(0) : slope_y;
  out.t.x = fx_z * g.mean_x - (ctx.x_clamped ? T(0) : fx_z / t.z * grad_j02);
  out.t.y = fy_z * g.mean_y - (ctx.y_clamped ? T(0) : fy_z / t.z * grad_j12);
  out.t.z = -fx_z * slope_x * g.mean_x - fy_z * slope_y * g.mean_y +
            (-fx_z * grad_j00 + fx_z * (ctx.slope_x + s_x) * grad_j02 - fy_z * grad_j11 +
             fy_z * (ctx.slope_y + s_y) * grad_j12) /
                t.z;
  out.logit_opacity = g.log_opacity * sigmoid(-ctx.logit_opacity);
  return out;
}

/// rgb = max(0, 0.5 + C0 dc + Σ basis_k(d) rest_k), d = normalised(p - camera centre).
///
///   dc [3]   rest [n, 3] coefficient-major   offset = p - centre, not zero
template <class T>
NGS_HD Vec3<T> sh_colour(int degree, Vec3<T> offset, const T* dc, const T* rest) {
  using std::sqrt;
  T basis[15];
  const T length2 = dot(offset, offset);
  const T inv = length2 > T(0) ? T(1) / sqrt(length2) : T(0);
  sh_rest_basis(degree, inv * offset, basis);
  T rgb[3];
  for (int c = 0; c < 3; ++c) rgb[c] = colour_of_dc(dc[c]);
  for (int k = 0; k < (degree + 1) * (degree + 1) - 1; ++k)
    for (int c = 0; c < 3; ++c) rgb[c] += basis[k] * rest[k * 3 + c];
  return {max2(rgb[0], T(0)), max2(rgb[1], T(0)), max2(rgb[2], T(0))};
}

/// The result of sh_colour and ∂L/∂ of it.
template <class T>
struct ColourAndGradient {
  Vec3<T> rgb, grad;
};
/// ∂L/∂ of dc and rest.
template <class T>
struct ShGradient {
  T dc[3], rest[45];
};

/// Adjoint of sh_colour; channels clamped at 0 (rgb == 0) pass no gradient. Writes out.dc and the rows of out.rest up
/// to `degree`; returns ∂L/∂offset.
template <class T>
NGS_HD Vec3<T> sh_colour_backward(int degree, Vec3<T> offset, const T* rest, const ColourAndGradient<T>& colour,
                                  ShGradient<T>& out) {
  using std::sqrt;
  const auto& [rgb, grad] = colour;
  const T g[3] = {rgb.x > T(0) ? grad.x : T(0), rgb.y > T(0) ? grad.y : T(0), rgb.z > T(0) ? grad.z : T(0)};
  for (int c = 0; c < 3; ++c) out.dc[c] = T(kShC0) * g[c];
  const T length2 = dot(offset, offset);
  if (degree < 1 || !(length2 > T(0))) return {T(0), T(0), T(0)};
  const T inv = T(1) / sqrt(length2);
  const Vec3<T> d = inv * offset;
  T basis[15], grad_basis[15];
  sh_rest_basis(degree, d, basis);
  for (int k = 0; k < (degree + 1) * (degree + 1) - 1; ++k) {
    grad_basis[k] = T(0);
    for (int c = 0; c < 3; ++c) {
      grad_basis[k] += rest[k * 3 + c] * g[c];
      out.rest[k * 3 + c] = basis[k] * g[c];
    }
  }
  const Vec3<T> grad_d = sh_rest_basis_backward(degree, d, grad_basis);
  return inv * (grad_d - dot(grad_d, d) * d);
}

}  // namespace ngs
