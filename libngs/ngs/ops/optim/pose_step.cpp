#include "ngs/ops/optim/pose_step.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "ngs/core/check.h"
#include "ngs/math/pixel_grid.h"

namespace ngs {
namespace {

constexpr int kBorder_px = 4, kParameters = 6, kExposurePasses = 5, kSteps = 6;
// Prior on the motion, relative to the information on the best determined parameter. A turn and a move that cancel up
// to the parallax within the model have (depth extent / distance)² of that information: 1/200 for an object that fills
// a tenth of its distance. Motions with less than a fifth of that would follow the errors of the model.
constexpr double kPrior = 1e-3;
constexpr float kSolid = 0.5f;        // least alpha; below it, the depth is that of the silhouette's rim
constexpr double kMinTexture = 1e-7;  // mean squared gradient, per px²: below 3e-4 it is noise

using Row = Eigen::Matrix<double, kParameters, 1>;
using Normal = Eigen::Matrix<double, kParameters, kParameters>;

double cauchy_weight(double residual) { return 1 / (1 + residual * residual / (kPoseResidual * kPoseResidual)); }

/// Matches the colours of `from` to those of `to`, channel by channel, by gain and offset: exposures differ between
/// photos. Least squares with Cauchy weights, as in the alignment.
void match_exposure(const ImageF& to, const std::vector<std::size_t>& pixels, ImageF& from) {
  for (int c = 0; c < from.channels; ++c) {
    double gain = 1, offset = 0;
    for (int pass = 0; pass < kExposurePasses; ++pass) {
      double w = 0, x = 0, y = 0, xx = 0, xy = 0;
      for (const std::size_t p : pixels) {
        const double a = double(from.data[p * std::size_t(from.channels) + std::size_t(c)]),
                     b = double(to.data[p * std::size_t(from.channels) + std::size_t(c)]),
                     weight = cauchy_weight(b - gain * a - offset);
        w += weight;
        x += weight * a;
        y += weight * b;
        xx += weight * a * a;
        xy += weight * a * b;
      }
      const double spread = w * xx - x * x;
      if (!(spread > 1e-6 * w * w)) break;
      gain = (w * xy - x * y) / spread;
      offset = (y - gain * x) / w;
    }
    for (std::size_t p = std::size_t(c); p < from.data.size(); p += std::size_t(from.channels))
      from.data[p] = float(gain * double(from.data[p]) + offset);
  }
}

/// Mean depth of the model, weighted by alpha.
double mean_depth(const RenderedView& view) {
  double depth = 0, alpha = 0;
  for (std::size_t p = 0; p < view.alpha.data.size(); ++p) {
    depth += double(view.depth.data[p]);
    alpha += double(view.alpha.data[p]);
  }
  return alpha > 0 ? depth / alpha : 0;
}

/// The image displacement per parameter of the pixel at ray (x, y, 1) and inverse relative depth q. Parameters are in
/// pixels: turns times f, moves times f over the mean depth.
std::array<Row, 2> flow_of(double x, double y, double q) {
  Row du, dv;
  du << -x * y, 1 + x * x, -y, q, 0, -x * q;
  dv << -(1 + y * y), x * y, x, 0, q, -y * q;
  return {du, dv};
}

/// Weighted sums of one linearisation; flow and error only without a motion.
struct Sums {
  Normal normal = Normal::Zero(), flow = Normal::Zero();
  Row rhs = Row::Zero();
  double error = 0, weight = 0, texture = 0;
};

/// The view's colour and the photo, and the pixels at which they are compared.
struct Compared {
  const ImageF &from, &to;
  const std::vector<std::size_t>& pixels;
};

/// Linearised where the camera of the view moves by `motion`: a pixel is compared with the point of the photo to which
/// its flow leads.
Sums linearise(const Compared& compared, const RenderedView& view, const Camera& camera, double depth,
               const Row& motion) {
  const auto& [from, to, pixels] = compared;
  const bool at_rest = motion.isZero(0);
  Sums s;
  for (const std::size_t p : pixels) {
    const int x = int(p % std::size_t(to.width_px)), y = int(p / std::size_t(to.width_px));
    if (std::min({x, y, to.width_px - 1 - x, to.height_px - 1 - y}) < kBorder_px) continue;
    const double alpha = double(view.alpha.data[p]), q = depth * alpha / double(view.depth.data[p]);
    const auto [du, dv] = flow_of((x + 0.5 - camera.cx) / camera.fx, (y + 0.5 - camera.cy) / camera.fy, q);
    const double to_x = x + du.dot(motion), to_y = y + dv.dot(motion);
    if (!(std::min({to_x, to_y, to.width_px - 1 - to_x, to.height_px - 1 - to_y}) >= kBorder_px)) continue;
    const auto photo_at = [&photo = compared.to, to_x, to_y](int c) {
      return read_bilinear(to_x + 0.5, to_y + 0.5, photo.width_px, photo.height_px,
                           [&](int px, int py) { return photo.at(px, py, c); });
    };
    if (at_rest) s.flow += alpha * (du * du.transpose() + dv * dv.transpose());
    const double share = alpha / to.channels;
    double xx = 0, xy = 0, yy = 0, xr = 0, yr = 0;  // of the image gradient and the residual, over the channels
    double over_one = 0;                            // Π (1 + r² / s²) - 1: one logarithm for all channels
    for (int c = 0; c < to.channels; ++c) {
      const double gx = 0.5 * double(from.at(x + 1, y, c) - from.at(x - 1, y, c)),
                   gy = 0.5 * double(from.at(x, y + 1, c) - from.at(x, y - 1, c)),
                   r = photo_at(c) - double(from.at(x, y, c)), cauchy = share * cauchy_weight(r);
      xx += cauchy * gx * gx;
      xy += cauchy * gx * gy;
      yy += cauchy * gy * gy;
      xr += cauchy * gx * r;
      yr += cauchy * gy * r;
      const double square = r * r / (kPoseResidual * kPoseResidual);
      over_one += square + over_one * square;
    }
    if (at_rest) s.error += share * std::log1p(over_one);
    s.normal += du * (xx * du + xy * dv).transpose() + dv * (xy * du + yy * dv).transpose();
    s.rhs -= xr * du + yr * dv;
    s.texture += xx + yy;
    s.weight += alpha;
  }
  return s;
}

float binomial(float a, float b, float c, float d, float e) {
  return 1 / 16.f * a + 4 / 16.f * b + 6 / 16.f * c + 4 / 16.f * d + 1 / 16.f * e;
}

/// Smooths the two pixels at either end of a row. Beyond the border, the outermost pixel is repeated.
void smooth_ends(const float* from, float* to, int width_px, int channels) {
  for (int x = 0; x < width_px; ++x) {
    if (x >= 2 && x < width_px - 2) continue;
    for (int c = 0; c < channels; ++c) {
      const auto at = [&](int k) { return from[std::clamp(x + k, 0, width_px - 1) * channels + c]; };
      to[x * channels + c] = binomial(at(-2), at(-1), at(0), at(1), at(2));
    }
  }
}

}  // namespace

ImageF smoothed_for_pose(const ImageF& in) {
  ImageF rows(in.width_px, in.height_px, in.channels), out = rows;
  const std::ptrdiff_t next = in.channels, length = std::ptrdiff_t(in.width_px) * next;
  for (int y = 0; y < in.height_px; ++y) {
    const float* from = in.data.data() + y * length;
    float* to = rows.data.data() + y * length;
    smooth_ends(from, to, in.width_px, in.channels);
    for (std::ptrdiff_t i = 2 * next; i < length - 2 * next; ++i)
      to[i] = binomial(from[i - 2 * next], from[i - next], from[i], from[i + next], from[i + 2 * next]);
  }
  const auto row = [&](int y) { return rows.data.data() + std::clamp(y, 0, in.height_px - 1) * length; };
  for (int y = 0; y < in.height_px; ++y) {
    const float *a = row(y - 2), *b = row(y - 1), *c = row(y), *d = row(y + 1), *e = row(y + 2);
    float* to = out.data.data() + y * length;
    for (std::ptrdiff_t i = 0; i < length; ++i) to[i] = binomial(a[i], b[i], c[i], d[i], e[i]);
  }
  return out;
}

Camera moved(Camera camera, const CameraMotion& motion) {
  const Eigen::Vector3d turn(motion.turn.x, motion.turn.y, motion.turn.z);
  const double angle = turn.norm();
  if (angle > 0) {
    const Eigen::Matrix3d r = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
    Mat3<double> rotation;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) rotation(i, j) = r(i, j);
    camera.rotation = rotation * camera.rotation;
    camera.translation = rotation * camera.translation;
  }
  camera.translation = camera.translation + motion.move;
  return camera;
}

PoseStep pose_step(const RenderedView& view, const ImageF& photo, const Camera& camera, const CameraMotion& so_far,
                   int pixel_step) {
  NGS_CHECK(view.colour.width_px == photo.width_px && view.colour.height_px == photo.height_px &&
                view.colour.channels == photo.channels && !view.depth.empty(),
            "pose_step: needs a view with depth and a photo of the same size");
  PoseStep step;
  const double depth = mean_depth(view), f_px = 0.5 * (camera.fx + camera.fy);
  if (!(depth > 0)) return step;
  ImageF from = smoothed_for_pose(view.colour);
  std::vector<std::size_t> pixels;
  for (int y = 0; y < photo.height_px; y += pixel_step)
    for (int x = 0; x < photo.width_px; x += pixel_step)
      if (view.alpha.at(x, y) > kSolid) pixels.push_back(std::size_t(y) * std::size_t(photo.width_px) + std::size_t(x));
  match_exposure(photo, pixels, from);
  const double turn_px = f_px, move_px = f_px / depth;  // per unit of each parameter
  const auto& [turn, move] = so_far;
  Row before, p = Row::Zero();
  before << turn_px * turn.x, turn_px * turn.y, turn_px * turn.z, move_px * move.x, move_px * move.y, move_px * move.z;
  Sums first;
  const auto rms_px = [&](const Row& motion) {
    return std::sqrt(std::max(0.0, motion.dot(first.flow * motion)) / first.weight);
  };
  for (int k = 0; k < kSteps; ++k) {
    const Sums sums = linearise({from, photo, pixels}, view, camera, depth, p);
    if (k == 0) first = sums;
    if (!(sums.weight > 0)) return step;
    if (k == 0) step.error = sums.error / sums.weight;
    if (!(sums.texture > kMinTexture * sums.weight)) return step;
    const double prior = kPrior * sums.normal.diagonal().maxCoeff();
    const Row more = (sums.normal + prior * Normal::Identity()).ldlt().solve(sums.rhs - prior * (before + p));
    if (!more.allFinite()) return step;
    p += more;
    if (rms_px(more) < kSettled_px) break;
  }
  step.motion = {{p[0] / turn_px, p[1] / turn_px, p[2] / turn_px}, {p[3] / move_px, p[4] / move_px, p[5] / move_px}};
  step.flow_px = rms_px(p);
  step.total_px = rms_px(before + p);
  step.determined = true;
  return step;
}

}  // namespace ngs
