#pragma once
// One Gaussian in front of one camera, and a reference of its projection in long double.
#include <algorithm>
#include <cmath>

#include "ngs/ops/splat/cloud_view.h"
#include "support/random.h"

namespace ngs::test::projection {

using Real = long double;

inline constexpr double kWidth = 1000, kHeight = 800, kFocal = 900, kBlur = 0.3;  // px, px²

inline Camera front_camera() {
  return {"", int(kWidth), int(kHeight), kFocal, 1.1 * kFocal, 480, 410, {{1, 0, 0, 0, 1, 0, 0, 0, 1}}, {}};
}

/// A Gaussian in camera coordinates, with values that float represents exactly.
struct Probe {
  Vec3<float> t;
  float rotation[4], log_scale[3], logit = 0;

  Probe(Random& random, double s0, double s1, double s2, double slope = 0.3) {
    const double z = random.uniform(2, 6);
    t = {float(random.uniform(-slope, slope) * z), float(random.uniform(-slope, slope) * z), float(z)};
    for (float& q : rotation) q = float(random.uniform(-1, 1));
    const double scale[3] = {s0, s1, s2};
    for (int k = 0; k < 3; ++k) log_scale[k] = float(std::log(scale[k]));
  }
};

/// The textbook form in long double; the determinant from the minors of V (Cauchy-Binet), which do not cancel.
struct Truth {
  Real a = 0, b = 0, c = 0, det_raw = 0, det = 0;
  Real raw_condition = 1, condition = 1;  // of det_raw; of a, c and det
  Real cross_condition = 2;               // of b, whose size is sqrt(a c)
  Truth(const Probe& p, const ProjectionCamera<float>& cam) {
    Real q[4], norm = 0, r[3][3];
    for (const float x : p.rotation) norm += Real(x) * x;
    for (int k = 0; k < 4; ++k) q[k] = p.rotation[k] / std::sqrt(norm);
    const Real w = q[0], x = q[1], y = q[2], z = q[3];
    const Real rows[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                          2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                          2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    for (int k = 0; k < 9; ++k) r[k / 3][k % 3] = rows[k];
    const Real sx = std::clamp<Real>(Real(p.t.x) / p.t.z, cam.x_lo, cam.x_hi);
    const Real sy = std::clamp<Real>(Real(p.t.y) / p.t.z, cam.y_lo, cam.y_hi);
    const Real u[2][3] = {{cam.f_x / Real(p.t.z), 0, -cam.f_x / Real(p.t.z) * sx},
                          {0, cam.f_y / Real(p.t.z), -cam.f_y / Real(p.t.z) * sy}};
    Real v[2][3] = {}, scale[3], length[2] = {};
    for (int k = 0; k < 3; ++k) scale[k] = std::exp(Real(p.log_scale[k]));
    for (int i = 0; i < 2; ++i)
      for (int k = 0; k < 3; ++k) {
        for (int l = 0; l < 3; ++l) v[i][k] += u[i][l] * r[l][k] * scale[k];
        length[i] += std::abs(u[i][k]);
      }
    for (int k = 0; k < 3; ++k) {
      a += v[0][k] * v[0][k];
      b += v[0][k] * v[1][k];
      c += v[1][k] * v[1][k];
    }
    Real spread = 0;  // error of the minors from rounding of the rows of U R
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3;
      const Real minor = v[0][k] * v[1][l] - v[0][l] * v[1][k];
      det_raw += minor * minor;
      spread += 4 * std::abs(minor) * scale[k] * scale[l] * length[0] * length[1];
    }
    raw_condition = 2 + spread / det_raw;
    for (int i = 0; i < 2; ++i) {  // and of their squares
      Real rows_spread = 0;
      for (int k = 0; k < 3; ++k) rows_spread += 2 * std::abs(v[i][k]) * scale[k] * length[i];
      condition = std::max(condition, rows_spread / ((i == 0 ? a : c) + Real(kBlur)));
    }
    for (int k = 0; k < 3; ++k)  // a needle along one row: the other row's error times the long row enters b only
      cross_condition += scale[k] * (std::abs(v[0][k]) * length[1] + std::abs(v[1][k]) * length[0]) /
                         std::sqrt((a + kBlur) * (c + kBlur));
    a += kBlur;
    c += kBlur;
    det = det_raw + kBlur * (a + c - 2 * kBlur) + Real(kBlur) * kBlur;
    condition += 2 + raw_condition * det_raw / det;
    cross_condition += condition;  // b is divided by det
  }
};

struct Projected {
  ProjectionCamera<float> camera;
  ProjectionContext<float> context{};
  ProjectedGaussian<float> out{};
  explicit Projected(const Probe& p, bool antialiased = false)
      : Projected(p, antialiased, projection_camera<float>(front_camera(), {})) {}
  Projected(const Probe& p, bool antialiased, const ProjectionCamera<float>& by) : camera(by) {
    camera.antialiased = antialiased;
    out = project_gaussian(camera, p.t, {p.rotation, p.log_scale, p.logit}, context);
  }
};

}  // namespace ngs::test::projection
