#pragma once
// Reference renderer in double: every Gaussian at every pixel, covariance by explicit matrix products. It uses no tiles
// (except the rectangle rule itself), spans or packing. Written from the published conventions of 3DGS and gsplat,
// independently of libngs (it may include plain structs only).
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "support/splat_case.h"

namespace ngs::test {

struct ReferencePixel {
  std::array<double, 3> rgb{};
  std::array<double, 2> label{};
  double depth = 0, transmittance = 1;
  double closest_threshold = 1;                // smallest relative distance of any alpha to 1/255 or of any T to 1e-4
  std::vector<std::pair<int, double>> weight;  // (Gaussian, alpha · T) in depth order
  std::vector<double> condition;               // per weight: relative error in units of rounding
};

struct ReferenceGaussian {
  double x, y, z, a, b, c, opacity, rgb[3];
  int tile_x0, tile_x1, tile_y0, tile_y1;
  bool visible;
};

inline ReferenceGaussian reference_gaussian(const SplatCase& c, int i, const SplatOptions& o) {
  ReferenceGaussian g{};
  const auto idx = std::size_t(i);
  const double* p = &c.position[idx * 3];
  double t[3];
  for (int r = 0; r < 3; ++r)
    t[r] = c.camera.rotation(r, 0) * p[0] + c.camera.rotation(r, 1) * p[1] + c.camera.rotation(r, 2) * p[2] +
           (&c.camera.translation.x)[r];
  g.z = t[2];
  if (t[2] <= (o.compat == Compat::kInria ? 0.2 : 0.01) * o.world_unit) return g;
  double q[4], norm = 0;
  for (int k = 0; k < 4; ++k) norm += c.rotation[idx * 4 + std::size_t(k)] * c.rotation[idx * 4 + std::size_t(k)];
  for (int k = 0; k < 4; ++k) q[k] = c.rotation[idx * 4 + std::size_t(k)] / std::sqrt(norm);
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  const double rot[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                            {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                            {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
  double sigma[3][3] = {}, s2[3];
  for (int k = 0; k < 3; ++k) s2[k] = std::exp(2 * c.log_scale[idx * 3 + std::size_t(k)]);
  for (int r = 0; r < 3; ++r)
    for (int s = 0; s < 3; ++s)
      for (int k = 0; k < 3; ++k) sigma[r][s] += rot[r][k] * s2[k] * rot[s][k];
  const Camera& cam = c.camera;
  const double mx = 0.15 * cam.width_px / cam.fx, my = 0.15 * cam.height_px / cam.fy;
  const double sx = std::clamp(t[0] / t[2], -cam.cx / cam.fx - mx, (cam.width_px - cam.cx) / cam.fx + mx);
  const double sy = std::clamp(t[1] / t[2], -cam.cy / cam.fy - my, (cam.height_px - cam.cy) / cam.fy + my);
  const double jac[2][3] = {{cam.fx / t[2], 0, -cam.fx * sx / t[2]}, {0, cam.fy / t[2], -cam.fy * sy / t[2]}};
  double u[2][3] = {};
  for (int r = 0; r < 2; ++r)
    for (int s = 0; s < 3; ++s)
      for (int k = 0; k < 3; ++k) u[r][s] += jac[r][k] * cam.rotation(k, s);
  double cov[2][2] = {};
  for (int r = 0; r < 2; ++r)
    for (int s = 0; s < 2; ++s)
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l) cov[r][s] += u[r][k] * sigma[k][l] * u[s][l];
  const double raw = cov[0][0] * cov[1][1] - cov[0][1] * cov[0][1];
  cov[0][0] += 0.3;
  cov[1][1] += 0.3;
  const double det = cov[0][0] * cov[1][1] - cov[0][1] * cov[0][1];
  g.a = cov[1][1] / det;
  g.b = -cov[0][1] / det;
  g.c = cov[0][0] / det;
  g.x = cam.fx * t[0] / t[2] + cam.cx;
  g.y = cam.fy * t[1] / t[2] + cam.cy;
  g.opacity = 1 / (1 + std::exp(-c.logit_opacity[idx]));
  if (o.antialiased) g.opacity *= std::sqrt(std::max(2.5e-5, raw / det));
  double rx, ry, shift = 0;
  if (o.compat == Compat::kInria) {
    const double mid = 0.5 * (cov[0][0] + cov[1][1]);
    rx = ry = std::ceil(3 * std::sqrt(mid + std::sqrt(std::max(0.1, mid * mid - det))));
    shift = 0.5;
  } else {
    const double extent = std::min(3.33, std::sqrt(std::max(0.0, 2 * std::log(255 * g.opacity))));
    rx = std::ceil(extent * std::sqrt(cov[0][0]));
    ry = std::ceil(extent * std::sqrt(cov[1][1]));
  }
  const int tx = (cam.width_px + 15) / 16, ty = (cam.height_px + 15) / 16;
  const auto tile = [](double v, int hi) { return int(std::clamp(std::trunc(v / 16), 0.0, double(hi))); };
  g.tile_x0 = tile(g.x - shift - rx, tx);
  g.tile_x1 = tile(g.x - shift + rx + 15, tx);
  g.tile_y0 = tile(g.y - shift - ry, ty);
  g.tile_y1 = tile(g.y - shift + ry + 15, ty);
  const Vec3<double> centre = cam.centre();
  double d[3] = {p[0] - centre.x, p[1] - centre.y, p[2] - centre.z};
  const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  for (double& v : d) v /= length;
  const double X = d[0], Y = d[1], Z = d[2];
  const double basis[15] = {-0.4886025119029199 * Y,
                            0.4886025119029199 * Z,
                            -0.4886025119029199 * X,
                            1.0925484305920792 * X * Y,
                            -1.0925484305920792 * Y * Z,
                            0.31539156525252005 * (2 * Z * Z - X * X - Y * Y),
                            -1.0925484305920792 * X * Z,
                            0.5462742152960396 * (X * X - Y * Y),
                            -0.5900435899266435 * Y * (3 * X * X - Y * Y),
                            2.890611442640554 * X * Y * Z,
                            -0.4570457994644658 * Y * (4 * Z * Z - X * X - Y * Y),
                            0.3731763325901154 * Z * (2 * Z * Z - 3 * X * X - 3 * Y * Y),
                            -0.4570457994644658 * X * (4 * Z * Z - X * X - Y * Y),
                            1.445305721320277 * Z * (X * X - Y * Y),
                            -0.5900435899266435 * X * (X * X - 3 * Y * Y)};
  for (int ch = 0; ch < 3; ++ch) {
    double v = 0.5 + 0.28209479177387814 * c.sh_dc[idx * 3 + std::size_t(ch)];
    for (int k = 0; k < 15; ++k) v += basis[k] * c.sh_rest[idx * 45 + std::size_t(k * 3 + ch)];
    g.rgb[ch] = std::max(0.0, v);
  }
  g.visible = true;
  return g;
}

/// The image, pixel by pixel, without background.
inline std::vector<ReferencePixel> reference_render(const SplatCase& c, const SplatOptions& o) {
  std::vector<ReferenceGaussian> g;
  for (int i = 0; i < c.gaussians; ++i) g.push_back(reference_gaussian(c, i, o));
  std::vector<int> order(g.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int i, int j) { return float(g[std::size_t(i)].z) < float(g[std::size_t(j)].z); });
  std::vector<ReferencePixel> image;
  for (int y = 0; y < c.camera.height_px; ++y)
    for (int x = 0; x < c.camera.width_px; ++x) {
      ReferencePixel& px = image.emplace_back();
      double front = 1;  // condition number of the transmittance
      for (const int i : order) {
        const ReferenceGaussian& k = g[std::size_t(i)];
        if (!k.visible || x / 16 < k.tile_x0 || x / 16 >= k.tile_x1 || y / 16 < k.tile_y0 || y / 16 >= k.tile_y1)
          continue;
        const double dx = k.x - (x + 0.5), dy = k.y - (y + 0.5);
        const double power = -0.5 * (k.a * dx * dx + k.c * dy * dy) - k.b * dx * dy;
        if (power > 0) continue;
        const double alpha = std::min(0.99, k.opacity * std::exp(power));
        px.closest_threshold = std::min(px.closest_threshold, std::abs(alpha * 255 - 1));
        if (alpha < 1.0 / 255) continue;
        const double next = px.transmittance * (1 - alpha);
        px.closest_threshold = std::min(px.closest_threshold, std::abs(next * 1e4 - 1));
        if (o.compat == Compat::kInria ? next < 1e-4 : next <= 1e-4) break;
        const double weight = alpha * px.transmittance;
        for (int ch = 0; ch < 3; ++ch) px.rgb[std::size_t(ch)] += weight * k.rgb[ch];
        for (int ch = 0; ch < 2; ++ch) px.label[std::size_t(ch)] += weight * c.label[std::size_t(i * 2 + ch)];
        px.depth += weight * k.z;
        px.weight.emplace_back(i, weight);
        // error of the power from rounding of the mean and of the conic, whose terms cancel along a needle
        const double spread = 0.5 * (k.a * dx * dx + k.c * dy * dy) + std::abs(k.b * dx * dy) +
                              std::abs((k.a * dx + k.b * dy) * k.x) + std::abs((k.b * dx + k.c * dy) * k.y);
        px.condition.push_back(spread + front);
        front += spread * alpha / (1 - alpha);
        px.transmittance = next;
      }
    }
  return image;
}

}  // namespace ngs::test
