#include "ngs/problem/scene_measures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ngs/math/median.h"
#include "ngs/math/sh.h"
#include "ngs/math/stable.h"

namespace ngs {
namespace {

constexpr double kLevels = 255;
constexpr double kNearest = 0.01;  // least camera z, in units of math/world_unit.h

struct Visible {
  Vec3<double> offset;  // from the camera, world
  double depth = 0;     // camera z
  double px_per_unit = 0;
  double picture_px2 = 0;
};

/// False: behind the camera or far outside the image.
bool in_view(const Camera& camera, const GaussianCloud& cloud, std::size_t i, double near_z, Visible& visible) {
  const float* p = &cloud.position[3 * i];
  const Vec3<double> x{double(p[0]), double(p[1]), double(p[2])};
  const Vec3<double> at = camera.to_camera(x);
  if (!(at.z > near_z)) return false;
  const double u = camera.fx * at.x / at.z + camera.cx, v = camera.fy * at.y / at.z + camera.cy;
  const double px_per_unit = std::max(camera.fx, camera.fy) / at.z;
  const double reach =
      3 * std::exp(double(*std::max_element(&cloud.log_scale[3 * i], &cloud.log_scale[3 * i] + 3))) * px_per_unit;
  if (u < -reach || v < -reach || u > camera.width_px + reach || v > camera.height_px + reach) return false;
  visible = {x - camera.centre(), at.z, px_per_unit, double(camera.width_px) * camera.height_px};
  return true;
}

/// Calls use(i, visible, opacity) for every camera and every usable Gaussian in its view.
template <class Use>
void for_each_visible(const GaussianCloud& cloud, std::span<const Camera> cameras, double world_unit, const Use& use) {
  for (const Camera& world : cameras) {
    const Camera camera = relative_to(world, cloud.origin);
    Visible visible;
    for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i)
      if (cloud.usable[i] && in_view(camera, cloud, i, kNearest * world_unit, visible))
        use(i, visible, double(sigmoid(cloud.logit_opacity[i])));
  }
}

double colour_distance2(const float* a, const float* b) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) sum += (double(a[c]) - double(b[c])) * (double(a[c]) - double(b[c]));
  return sum;
}

template <class Use>
void for_each_edge(const KnnGraph& graph, const Use& use) {
  const auto k = std::size_t(graph.neighbours);
  for (std::size_t e = 0; e < graph.index.size(); ++e) use(e / k, std::size_t(graph.index[e]));
}

}  // namespace

double view_dependence_levels(const GaussianCloud& cloud, std::span<const Camera> cameras, double world_unit) {
  const auto bands = std::size_t(cloud.rest_count());
  double most = 0;
  if (bands == 0) return 0;
  for_each_visible(cloud, cameras, world_unit, [&](std::size_t i, const Visible& visible, double opacity) {
    double basis[15];
    const double length = std::sqrt(dot(visible.offset, visible.offset));
    sh_rest_basis(cloud.sh_degree, (1 / length) * visible.offset, basis);
    for (std::size_t c = 0; c < 3; ++c) {
      double change = 0;
      for (std::size_t k = 0; k < bands; ++k) change += basis[k] * double(cloud.sh_rest[(i * bands + k) * 3 + c]);
      most = std::max(most, opacity * std::abs(change));
    }
  });
  return kLevels * most;
}

double antialias_levels(const GaussianCloud& cloud, std::span<const Camera> cameras, const SplatOptions& splat) {
  double most = 0;
  if (!splat.antialiased) return 0;
  for_each_visible(cloud, cameras, splat.world_unit, [&](std::size_t i, const Visible& visible, double opacity) {
    float s[3] = {cloud.log_scale[3 * i], cloud.log_scale[3 * i + 1], cloud.log_scale[3 * i + 2]};
    std::sort(s, s + 3);
    double compensation = 1;  // sqrt(det / det blurred), if the two shorter axes are parallel to the image
    for (int a = 0; a < 2; ++a) {
      const double px = std::exp(double(s[a])) * visible.px_per_unit;
      compensation *= std::sqrt(px * px / (px * px + splat.blur_px2));
    }
    most = std::max(most, opacity * (1 - compensation));
  });
  return kLevels * most;
}

double straddling_bound_px(const GaussianCloud& cloud, std::span<const Camera> cameras, const SplatOptions& splat) {
  std::vector<double> bound(std::size_t(cloud.size()), 0.0);
  for_each_visible(cloud, cameras, splat.world_unit, [&](std::size_t i, const Visible& visible, double opacity) {
    float s[3] = {cloud.log_scale[3 * i], cloud.log_scale[3 * i + 1], cloud.log_scale[3 * i + 2]};
    std::sort(s, s + 3);
    double area =
        2 * std::numbers::pi;  // integral of a Gaussian of unit scales; at most half of it is on the wrong side
    for (int a = 1; a < 3; ++a) {
      const double px = std::exp(double(s[a])) * visible.px_per_unit;
      area *= std::sqrt(px * px + splat.blur_px2);
    }
    bound[i] += 0.5 * opacity * std::min(area, visible.picture_px2);
  });
  return bound.empty() ? 0 : *std::max_element(bound.begin(), bound.end());
}

double neighbour_rms_levels(const KnnGraph& graph, Rows<const float, 3> colour) {
  double sum = 0;
  for_each_edge(graph, [&](std::size_t i, std::size_t j) {
    sum += colour_distance2(colour.row(std::int64_t(i)), colour.row(std::int64_t(j)));
  });
  return graph.index.empty() ? 0 : kLevels * std::sqrt(sum / double(graph.index.size()) / 3);
}

double neighbour_max_levels(const KnnGraph& graph, Rows<const float, 3> colour) {
  double most = 0;
  for_each_edge(graph, [&](std::size_t i, std::size_t j) {
    for (int c = 0; c < 3; ++c)
      most = std::max(most, std::abs(double(colour.row(std::int64_t(i))[c]) - double(colour.row(std::int64_t(j))[c])));
  });
  return kLevels * most;
}

double colour_range_levels(Rows<const float, 3> colour) {
  double range = 0;
  for (int c = 0; c < 3 && colour.n > 0; ++c) {
    float low = colour.row(0)[c], high = low;
    for (std::int64_t i = 0; i < colour.n; ++i) {
      low = std::min(low, colour.row(i)[c]);
      high = std::max(high, colour.row(i)[c]);
    }
    range = std::max(range, double(high) - double(low));
  }
  return kLevels * range;
}

namespace {

constexpr int kDeviationRadius_px = 3;

/// Variance of one channel in the patch about (x, y).
double window_variance(const ImageF& photo, int x, int y, int channel) {
  double first = 0, second = 0;
  for (int v = y - kDeviationRadius_px; v <= y + kDeviationRadius_px; ++v)
    for (int u = x - kDeviationRadius_px; u <= x + kDeviationRadius_px; ++u) {
      const double value = double(photo.at(u, v, channel)) -
                           double(photo.at(x, y, channel));  // relative to the centre: avoids cancellation
      first += value;
      second += value * value;
    }
  constexpr double kCount = (2 * kDeviationRadius_px + 1) * (2 * kDeviationRadius_px + 1);
  return std::max(0.0, second / kCount - first / kCount * first / kCount);
}

}  // namespace

double contour_deviation_levels(const ImageF& photo, MaskPlane mask) {
  constexpr int kRadius = kDeviationRadius_px;
  const int w = mask.width_px, h = mask.height_px;
  const auto inside = [&](int x, int y) { return mask.data[std::size_t(y) * std::size_t(w) + std::size_t(x)] != 0; };
  double sum = 0, patches = 0;
  for (int y = kRadius; y + kRadius < h; ++y)
    for (int x = kRadius; x + kRadius < w; ++x) {
      if (!inside(x, y) || (inside(x - 1, y) && inside(x + 1, y) && inside(x, y - 1) && inside(x, y + 1))) continue;
      for (int c = 0; c < photo.channels; ++c) {
        sum += window_variance(photo, x, y, c);
        ++patches;
      }
    }
  return patches > 0 ? kLevels * std::sqrt(sum / patches) : 0;
}

double cells_per_spacing(const std::vector<float>& nearest_distance, double extent, int finest) {
  if (nearest_distance.empty()) return 0;
  const double spacing = upper_median({nearest_distance.begin(), nearest_distance.end()});
  return spacing > 0 ? extent / finest / spacing : INFINITY;
}

double gain_in_standard_errors(const std::vector<double>& gains) {
  const auto n = double(gains.size());
  if (gains.size() < 2) return 0;
  double sum = 0, square = 0;
  for (const double g : gains) sum += g;
  for (const double g : gains) square += (g - sum / n) * (g - sum / n);
  const double error = std::sqrt(square / n / n);
  return error > 0 ? sum / n / error : sum == 0 ? 0 : std::copysign(INFINITY, sum);
}

double normal_score(double gain_in_standard_errors, std::size_t views) {
  if (views < 2) return 0;
  const double freedom = double(views) - 1;
  const double t = gain_in_standard_errors * std::sqrt(freedom / double(views));  // t of the unbiased variance
  const double limit = (1 - 1 / (4 * freedom)) * std::sqrt(2 * freedom);
  if (std::isinf(t)) return std::copysign(limit, t);
  return t * (1 - 1 / (4 * freedom)) / std::sqrt(1 + t * t / (2 * freedom));
}

NarrowParts narrow_parts(MaskPlane mask) {
  constexpr std::int32_t kReach = kNarrow_px / 2;
  const std::vector<std::int32_t> depth = chessboard_distance(mask, Outside::kUnknown);
  std::vector<std::uint8_t> no_middle(depth.size());  // 1: not the centre of such a square
  for (std::size_t p = 0; p < depth.size(); ++p) no_middle[p] = depth[p] <= kReach;
  const std::vector<std::int32_t> away =
      chessboard_distance({no_middle.data(), mask.width_px, mask.height_px}, Outside::kUnknown);
  NarrowParts parts;
  for (std::size_t p = 0; p < depth.size(); ++p)
    if (depth[p] > 0) {
      ++parts.all_px2;
      parts.narrow_px2 += away[p] > kReach;
    }
  return parts;
}

double weight_outside(const ImageF& label, int x0, int y0, int x1, int y1) {
  double outside = 0, all = 0;
  for (int y = 0; y < label.height_px; ++y)
    for (int x = 0; x < label.width_px; ++x)
      for (int c = 0; c < label.channels; ++c) {
        const double value = double(label.at(x, y, c));
        all += value;
        if (x < x0 || x >= x1 || y < y0 || y >= y1) outside += value;
      }
  return all > 0 ? outside / all : 0;
}

}  // namespace ngs
