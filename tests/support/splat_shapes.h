#pragma once
// Models made of surfaces of opaque discs, for tests of camera placement.
#include <cmath>

#include "ngs/math/vec.h"
#include "ngs/scene/gaussian_cloud.h"
#include "support/random.h"

namespace ngs::test {

/// Adds a Gaussian with these standard deviations along x, y and z; its opacity is 0.95 unless given.
inline void add_gaussian(GaussianCloud& cloud, Vec3<double> at, Vec3<double> deviation, Vec3<double> dc = {0, 0, 0},
                         double logit_opacity = 3) {
  const auto row = std::size_t(cloud.size());
  cloud.resize(cloud.size() + 1, cloud.sh_degree);
  for (std::size_t k = 0; k < 3; ++k) {
    cloud.position[3 * row + k] = float((&at.x)[k]);
    cloud.log_scale[3 * row + k] = float(std::log((&deviation.x)[k]));
    cloud.sh_dc[3 * row + k] = float((&dc.x)[k]);
  }
  cloud.rotation[4 * row] = 1;
  cloud.logit_opacity[row] = float(logit_opacity);
}

/// Adds a round Gaussian.
inline void add_gaussian(GaussianCloud& cloud, Vec3<double> at, double deviation, Vec3<double> dc = {0, 0, 0},
                         double logit_opacity = 3) {
  add_gaussian(cloud, at, Vec3<double>{deviation, deviation, deviation}, dc, logit_opacity);
}

/// A sphere of touching Gaussians.
inline void add_sphere(GaussianCloud& cloud, Vec3<double> centre, double radius, int count) {
  const double deviation = 1.2 * radius / std::sqrt(double(count));
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z), turn = 2.39996322972865332 * i;
    const Vec3<double> d{r * std::cos(turn), r * std::sin(turn), z};
    add_gaussian(cloud, centre + radius * d, deviation, {2 * d.x, 2 * d.y, 2 * d.z});
  }
}

/// The six sides of a box, with a grid of `step`.
inline void add_box(GaussianCloud& cloud, Vec3<double> lo, Vec3<double> hi, double step) {
  const double l[3] = {lo.x, lo.y, lo.z}, h[3] = {hi.x, hi.y, hi.z};
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (double a = l[u] + 0.5 * step; a < h[u]; a += step)
      for (double b = l[v] + 0.5 * step; b < h[v]; b += step)
        for (const double side : {l[axis], h[axis]}) {
          double p[3];
          p[axis] = side;
          p[u] = a;
          p[v] = b;
          add_gaussian(cloud, {p[0], p[1], p[2]}, 0.6 * step, {p[0], p[1], p[2]});
        }
  }
}

/// A square of side 2 · half at height z.
inline void add_floor(GaussianCloud& cloud, double half, double z, double step) {
  for (double x = -half + 0.5 * step; x < half; x += step)
    for (double y = -half + 0.5 * step; y < half; y += step) add_gaussian(cloud, {x, y, z}, 0.6 * step, {x, y, 0.5});
}

/// A room of 4 x 3 x 2.4 with a table and three boxes in it.
inline GaussianCloud furnished_room() {
  GaussianCloud cloud;
  add_box(cloud, {-2, -1.5, 0}, {2, 1.5, 2.4}, 0.1);
  add_box(cloud, {-0.9, -0.5, 0.6}, {0.4, 0.4, 0.7}, 0.07);
  add_box(cloud, {1.2, 0.7, 0}, {1.9, 1.4, 1.2}, 0.07);
  add_box(cloud, {-1.9, 0.8, 0}, {-1.2, 1.4, 0.8}, 0.07);
  add_box(cloud, {0.9, -1.4, 0}, {1.5, -0.9, 0.5}, 0.07);
  return cloud;
}

/// The model rotated, scaled and translated.
inline GaussianCloud transformed(GaussianCloud cloud, const Mat3<double>& turn, double scale, Vec3<double> shift) {
  for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i) {
    float* p = &cloud.position[3 * i];
    const Vec3<double> q = scale * (turn * Vec3<double>{p[0], p[1], p[2]}) + shift;
    p[0] = float(q.x);
    p[1] = float(q.y);
    p[2] = float(q.z);
    for (std::size_t k = 0; k < 3; ++k) cloud.log_scale[3 * i + k] += float(std::log(scale));
  }
  return cloud;  // its Gaussians are round
}

}  // namespace ngs::test
