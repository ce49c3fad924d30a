#pragma once
// Work per Gaussian of a view, on any device: projection, tile intersection, channel values, and the adjoint from the
// sums over pixels to the cloud's columns. Internal to ops; templated on the storage scalar S.  paper.md §5.1
#include <limits>

#include "ngs/math/elementary.h"
#include "ngs/ops/splat/project_kernels.h"
#include "ngs/ops/splat/splat_options.h"
#include "ngs/ops/splat/splat_step_kernels.h"
#include "ngs/ops/splat/tile_types.h"
#include "ngs/scene/camera.h"
#include "ngs/scene/views.h"

namespace ngs {

/// A cloud as arrays of S. Members as in GaussianCloud; null sh_dc: colour is not evaluated.
template <class S>
struct CloudView {
  std::int64_t size = 0;
  const S *position = nullptr, *rotation = nullptr, *log_scale = nullptr, *logit_opacity = nullptr;
  const S *sh_dc = nullptr, *sh_rest = nullptr;
  int sh_degree = 0;                                         // bands to evaluate
  int rest_stride = 0;                                       // coefficients stored per Gaussian
  const std::uint8_t *usable = nullptr, *include = nullptr;  // null: all

  NGS_HD GaussianShape<S> shape(std::int64_t i) const {
    return {rotation + i * 4, log_scale + i * 3, logit_opacity[i]};
  }
};

/// ∂L/∂(columns of CloudView); any pointer may be null (not wanted). Rows of invisible Gaussians are set to 0.
template <class S>
struct CloudGradientView {
  S *position = nullptr, *rotation = nullptr, *log_scale = nullptr, *logit_opacity = nullptr;
  S *sh_dc = nullptr, *sh_rest = nullptr, *label = nullptr, *mean_px = nullptr;  // sh_rest null: these are constants
  std::uint8_t* visible = nullptr;
  const std::uint8_t* label_only = nullptr;    // [N] 1: only `label` is wanted, the other columns are 0; null: none
  const std::int32_t* gradient_row = nullptr;  // [N] row of this Gaussian's gradient, -1: none; null: row i
  std::int64_t rows = 0;                       // output rows if `gradient_row` is not null
};

struct TileRect {
  std::uint16_t x_begin, x_end, y_begin, y_end;  // half open, in tiles
};

/// The camera in coordinates relative to `origin` (GaussianCloud::origin), with the Jacobian limits of gsplat,
/// which for a centred principal point are the 1.3 tan(fov/2) of 3DGS.
template <class S>
ProjectionCamera<S> projection_camera(const Camera& camera, const SplatOptions& options) {
  const double margin_x = 0.15 * camera.width_px / camera.fx, margin_y = 0.15 * camera.height_px / camera.fy;
  return {mat3_cast<S>(camera.rotation),
          S(camera.fx),
          S(camera.fy),
          S(camera.cx),
          S(camera.cy),
          S(-camera.cx / camera.fx - margin_x),
          S((camera.width_px - camera.cx) / camera.fx + margin_x),
          S(-camera.cy / camera.fy - margin_y),
          S((camera.height_px - camera.cy) / camera.fy + margin_y),
          S(near_plane(options.compat) * options.world_unit),
          S(options.blur_px2),
          options.antialiased};
}

/// p - centre in the wide scalar: both may be far from the origin and close to each other.
template <class S>
NGS_HD Vec3<WideOf<S>> offset_from(const Vec3<double>& centre, const S* p) {
  using W = WideOf<S>;
  return {W(p[0]) - W(centre.x), W(p[1]) - W(centre.y), W(p[2]) - W(centre.z)};
}
template <class S, class W>
NGS_HD Vec3<S> narrowed(Vec3<W> v) {
  return {S(v.x), S(v.y), S(v.z)};
}

/// Rounds towards zero after clamping to [lo, hi]; NaN gives lo.
template <class S>
NGS_HD int clamped_int(S x, int lo, int hi) {
  const double v = double(x);
  return v > lo ? (v < hi ? int(v) : hi) : lo;
}

/// The members of SplatRecord that depend on the opacity alone.
template <class S>
NGS_HD S max_mahalanobis2_of(S opacity) {
  return S(2) * log_of(S(255) * opacity);
}
template <class S>
NGS_HD S log2_opacity_of(S opacity) {
  using std::log2;
  return S(log2(WideOf<S>(opacity)));
}

/// Radius of gsplat's tile rectangle in standard deviations.
NGS_HD inline double tile_extent(double opacity) { return min2(3.33, std::sqrt(max_mahalanobis2_of(opacity))); }

/// The rectangle of tiles that a Gaussian may touch, by the rule of `compat`: 3DGS takes 3 sigma of the longer axis,
/// gsplat an opacity-aware extent per axis. Both visit whole tiles, so their results differ at tile borders.
template <class S>
NGS_HD TileRect tile_rect(const ProjectedGaussian<S>& p, Compat compat, int tiles_x, int tiles_y) {
  double radius_x, radius_y;
  const double xx = double(p.cov_xx), yy = double(p.cov_yy), det = double(p.det);
  if (compat == Compat::kInria) {
    const double mid = 0.5 * (xx + yy);
    radius_x = radius_y = std::ceil(3.0 * std::sqrt(mid + std::sqrt(max2(0.1, mid * mid - det))));
  } else {
    const double extent = tile_extent(double(p.opacity));
    radius_x = std::ceil(extent * std::sqrt(xx));
    radius_y = std::ceil(extent * std::sqrt(yy));
  }
  // 3DGS puts pixel centres at integers: its coordinate is ours - 0.5.
  const double shift = compat == Compat::kInria ? 0.5 : 0.0;
  const double x = double(p.mean_x) - shift, y = double(p.mean_y) - shift;
  const auto tile = [](double v, int hi) { return std::uint16_t(clamped_int(v / kTilePx, 0, hi)); };
  const double round_up = kTilePx - 1;
  return {tile(x - radius_x, tiles_x), tile(x + radius_x + round_up, tiles_x), tile(y - radius_y, tiles_y),
          tile(y + radius_y + round_up, tiles_y)};
}

template <class S>
NGS_HD SplatRecord<S> record_of(const ProjectedGaussian<S>& p, WideOf<S> mean_x, WideOf<S> mean_y) {
  using std::sqrt;
  const S max_mahalanobis2 = max_mahalanobis2_of(p.opacity);
  const S reach2 = max2(max_mahalanobis2, S(0)), half_width = sqrt(reach2 * p.cov_xx),
          half_height = sqrt(reach2 * p.cov_yy);
  const S log2_opacity = log2_opacity_of(p.opacity);
  return {mean_x,          mean_y,           PowerForm<S>::of(p.conic_a, p.conic_b, p.cov_yy),
          log2_opacity,    max_mahalanobis2, S(1) / p.det,
          half_width,      half_height,      -p.conic_b / p.conic_a * half_height,
          S(1) / p.conic_c};
}

/// Tiles [first, end) of one row of tiles: TileSpan as stored, TileRange as computed.
struct TileSpan {
  std::uint16_t first, end;
};
struct TileRange {
  int first, end;
};

/// {u: quadratic form <= max_mahalanobis2} about the mean, with precomputed inverses. T is float or double.
template <class T>
struct EllipseShape {
  T a, b, max_mahalanobis2;                                     // of the quadratic form a u² + 2 b u v + c v²
  T inv_det, inv_c;                                             // 1 / (a c - b²), 1 / c
  T half_width, half_height;                                    // of its bounding box, px
  static constexpr T kEps = std::numeric_limits<T>::epsilon();  // a member: CUDA device code cannot call it
};

/// Intersects the ellipse about (mean_x, mean_y) with row `ty` of tiles: the tiles in `within` that have a pixel centre
/// in the ellipse; {0, 0}: none.
///
/// Within the row the ellipse is widest at its own leftmost and rightmost points, or at the row's edge nearest to them.
/// Rounding may add tiles, never remove any: the squares under the roots and both ends of the span are widened by their
/// cancellation error.
/// Branch-free, so that the compiler can vectorise a loop over Gaussians.
template <class T>
NGS_HD inline TileRange tiles_of_row(const EllipseShape<T>& g, double mean_x, double mean_y, TileRange within, int ty) {
  constexpr T kEps = EllipseShape<T>::kEps, kSlack = T(kSpanSlackPx);
  const double y_lo = ty * kTilePx + 0.5, y_hi = y_lo + (kTilePx - 1);
  const T height = g.half_height + kSlack;
  const T v_lo = max2(T(y_lo - mean_y), -height), v_hi = min2(T(y_hi - mean_y), height);
  const T v_right = -g.b * g.inv_c * g.half_width, v_at_right = clamp3(v_right, v_lo, v_hi),
          v_at_left = clamp3(-v_right, v_lo, v_hi);
  const T inv_a = T(1) / g.a, bound = T(1 + 8 * kEps) * g.max_mahalanobis2 * g.a;
  const T right = -g.b * v_at_right, right_root = std::sqrt(max2(T(0), bound - v_at_right * v_at_right * g.inv_det));
  const T left = -g.b * v_at_left, left_root = std::sqrt(max2(T(0), bound - v_at_left * v_at_left * g.inv_det));
  const T right_slack = kSlack + (std::fabs(right) + right_root) * inv_a * (4 * kEps),
          left_slack = kSlack + (std::fabs(left) + left_root) * inv_a * (4 * kEps);
  // Pixel centres are at +0.5: column x intersects if x + 0.5 lies in [x_lo, x_hi].
  const T x = T(mean_x - 0.5), x_hi = x + (inv_a * (right + right_root) + right_slack),
          x_lo = x + (inv_a * (left - left_root) - left_slack);
  const T to = T(within.end), first = x_lo / T(kTilePx), last = x_hi / T(kTilePx);
  const int from_tile = int(first > 0 ? (first < to ? first : to) : 0),
            to_tile = int(last > -1 ? (last < to ? last : to) : -1);
  const int span_first = from_tile < within.first ? within.first : from_tile,
            span_last = to_tile < within.end - 1 ? to_tile : within.end - 1;
  const bool misses = (v_lo > v_hi) | (x_hi < 0) | (span_last < span_first);
  return {misses ? 0 : span_first, misses ? 0 : span_last + 1};
}

/// The tiles of row `ty` that a Gaussian intersects.
template <class S>
NGS_HD TileSpan tile_span(const SplatRecord<S>& g, const TileRect& r, int ty) {
  using T = std::conditional_t<std::is_same_v<S, float>, float, double>;  // tile indices have no derivative
  const EllipseShape<T> shape{T(g.form.a()), T(g.form.b()),   T(g.max_mahalanobis2), T(g.inv_det),
                              T(g.inv_c),    T(g.half_width), T(g.half_height)};
  const TileRange range = tiles_of_row(shape, double(g.mean_x), double(g.mean_y), {r.x_begin, r.x_end}, ty);
  return {std::uint16_t(range.first), std::uint16_t(range.end)};
}

/// Transmittance at which a pixel stops: 3DGS stops below 1e-4, gsplat at 1e-4.
inline double transmittance_stop(Compat compat) {
  return compat == Compat::kInria ? kTransmittanceStop : double(std::nextafter(float(kTransmittanceStop), 1.f));
}

/// The record relative to a tile's first pixel centre; subtracted in the wide scalar.
template <class S>
NGS_HD TileGaussian<S> tile_gaussian(const SplatRecord<S>& g, const TileFrame& frame) {
  using W = WideOf<S>;
  return {S(g.mean_x - W(frame.x_px + 0.5)), S(g.mean_y - W(frame.y_px + 0.5)), g.log2_opacity, g.form};
}

template <class S>
struct VisibleGaussian {
  SplatRecord<S> record;
  S depth;  // camera z
  TileRect rect;
};

/// The per-view constants of projection and culling.
template <class S>
struct ViewProjector {
  using Wide = WideOf<S>;
  ProjectionCamera<S> camera;
  ProjectionCamera<Wide> wide;
  Vec3<double> centre;
  double spread;   // px; largest scale · spread / z bounds the projected standard deviation without the filter
  double blur_px;  // px; bound of the low-pass filter's part of the radius
  int width_px, height_px, tiles_x, tiles_y;
  Compat compat;
  TileRect drawn;  // bounding rectangle of the tiles to rasterise
  float far_z;     // Gaussians at this camera z or beyond are culled, world

  /// The centre of Gaussian i relative to the camera's, in world axes.
  NGS_HD Vec3<Wide> offset(const CloudView<S>& cloud, std::int64_t i) const {
    return offset_from(centre, cloud.position + i * 3);
  }

  static constexpr double kRadii = 3.5, kRounding_px = 2;
  /// Conservative cull without the covariance: true only if tile_rect would miss `drawn`. Bounds: both radii are at
  /// most 3.33 (cov_xx + cov_yy + 0.32)^½ + 1 px, and cov_xx + cov_yy <= (largest scale · `spread` / z)² + 2 blur. All
  /// terms are multiplied by z; the factors exceed 3.33 and 1 to allow for rounding. Branch-free, so that a loop over
  /// Gaussians can be vectorised.
  NGS_HD bool outside_frustum(const CloudView<S>& cloud, std::int64_t i) const {
    const Vec3<Wide> t = wide.rotation * offset(cloud, i);
    const S* log_scale = cloud.log_scale + i * 3;
    const double x = double(t.x), y = double(t.y), z = double(t.z);
    const double column = double(wide.f_x) * x + double(wide.c_x) * z,
                 row = double(wide.f_y) * y + double(wide.c_y) * z;
    const double left = kTilePx * drawn.x_begin * z - column, right = column - kTilePx * drawn.x_end * z;
    const double above = kTilePx * drawn.y_begin * z - row, below = row - kTilePx * drawn.y_end * z;
    const double off = max2(max2(left, right), max2(above, below));
    const float largest =
        max2(max2(float(double(log_scale[0])), float(double(log_scale[1]))), float(double(log_scale[2])));
    return off > kRadii * (double(exp_at_least(largest)) * spread + blur_px * z) + kRounding_px * z;
  }

  /// False for a Gaussian that cannot reach a pixel.
  NGS_HD bool project(const CloudView<S>& cloud, std::int64_t i, VisibleGaussian<S>& out) const {
    using std::isfinite;
    if ((cloud.usable && !cloud.usable[i]) || (cloud.include && !cloud.include[i])) return false;
    const Vec3<Wide> t_wide = wide.rotation * offset(cloud, i);
    const Vec3<S> t = narrowed<S>(t_wide);
    if (!(t.z > camera.near_z && double(t.z) < double(far_z))) return false;
    ProjectionContext<S> ctx;
    const ProjectedGaussian<S> p = project_gaussian(camera, t, cloud.shape(i), ctx);
    if (!(p.opacity >= S(kAlphaMin)) || !(p.det > S(0)) || !isfinite(double(p.det)) || !isfinite(double(p.mean_x)) ||
        !isfinite(double(p.mean_y)))
      return false;
    out.rect = tile_rect(p, compat, tiles_x, tiles_y);
    if (out.rect.x_begin >= out.rect.x_end || out.rect.y_begin >= out.rect.y_end) return false;
    out.record =
        record_of<S>(p, wide.f_x * (t_wide.x / t_wide.z) + wide.c_x, wide.f_y * (t_wide.y / t_wide.z) + wide.c_y);
    out.depth = t.z;
    return true;
  }
};

template <class S>
ViewProjector<S> view_projector(const Camera& camera, const SplatOptions& options) {
  const ProjectionCamera<double> c = projection_camera<double>(camera, options);
  const auto row_length = [](double f, double lo, double hi) { return f * portable_hypot(1.0, std::max(-lo, hi)); };
  const int tiles_x = tiles_across(camera.width_px), tiles_y = tiles_across(camera.height_px);
  return {projection_camera<S>(camera, options),
          projection_camera<WideOf<S>>(camera, options),
          camera.centre(),
          portable_hypot(row_length(c.f_x, c.x_lo, c.x_hi), row_length(c.f_y, c.y_lo, c.y_hi)),
          std::sqrt(2 * c.blur + 0.32),
          camera.width_px,
          camera.height_px,
          tiles_x,
          tiles_y,
          options.compat,
          {0, std::uint16_t(tiles_x), 0, std::uint16_t(tiles_y)},
          std::numeric_limits<float>::infinity()};
}

/// The composited channels: rgb (if colour), the label columns, camera z (if depth).
template <class S>
struct ChannelPlan {
  bool colour = true, depth = false;
  Matrix<const S> label;                 // [N, K], n = 0: none
  Vec3<S> background{S(0), S(0), S(0)};  // of the colour channels
  NGS_HD int labels() const { return label.n > 0 ? label.c : 0; }
  NGS_HD int count() const { return (colour ? 3 : 0) + labels() + (depth ? 1 : 0); }

  /// Writes the channel values of Gaussian i at depth `z` to row [count].
  NGS_HD void fill(const ViewProjector<S>& view, const CloudView<S>& cloud, std::int64_t i, S z, S* row) const {
    if (colour) {
      const Vec3<S> rgb = sh_colour(cloud.sh_degree, narrowed<S>(view.offset(cloud, i)), cloud.sh_dc + i * 3,
                                    cloud.sh_rest + i * cloud.rest_stride * 3);
      *row++ = rgb.x, *row++ = rgb.y, *row++ = rgb.z;
    }
    for (int k = 0; k < labels(); ++k) *row++ = label.row(i)[k];
    if (depth) *row = z;
  }
};

/// Adjoint of projection: sums the gradients of a Gaussian's (Gaussian, tile) pairs [begin, end) and maps them to the
/// cloud's columns.
template <class S>
struct GaussianBackward {
  using Wide = WideOf<S>;
  ViewProjector<S> view;
  CloudView<S> cloud;
  ChannelPlan<S> plan;
  Matrix<const S> pairs;  // [pairs, kPairGeometry + count]
  CloudGradientView<S> out;

  template <int N>
  struct Sums {
    S of[N];
  };
  /// Sums of N columns over the pairs, interleaved to hide the latency of the additions.
  template <int N>
  NGS_HD Sums<N> sums(int first, std::int64_t begin, std::int64_t end) const {
    Wide total[N] = {};
    for (std::int64_t slot = begin; slot < end; ++slot)
      for (int c = 0; c < N; ++c) total[c] += Wide(pairs.row(slot)[first + c]);
    Sums<N> out;
    for (int c = 0; c < N; ++c) out.of[c] = S(total[c]);
    return out;
  }

  NGS_HD void gather(std::int64_t i, const S* value, std::int64_t begin, std::int64_t end) const {
    const std::int64_t to = out.gradient_row ? out.gradient_row[i] : i;
    if (to < 0) return;
    int channel = kPairGeometry + (plan.colour ? 3 : 0);
    for (int k = 0; k < plan.labels(); ++k, ++channel)
      if (out.label) out.label[to * plan.labels() + k] = sums<1>(channel, begin, end).of[0];
    if (out.visible) out.visible[to] = 1;
    if (!out.label_only || !out.label_only[i]) gather_shape_and_colour({i, to}, value, begin, end);
  }

 private:
  /// A Gaussian and the row of its gradient.
  struct Row {
    std::int64_t i, to;
  };
  NGS_HD void gather_shape_and_colour(Row row, const S* value, std::int64_t begin, std::int64_t end) const {
    const auto [i, to] = row;
    const Vec3<Wide> wide_offset = view.offset(cloud, i);
    const Vec3<S> offset = narrowed<S>(wide_offset), t = narrowed<S>(view.wide.rotation * wide_offset);
    ProjectionContext<S> ctx;
    const ProjectedGaussian<S> p = project_gaussian(view.camera, t, cloud.shape(i), ctx);
    const auto [mean_x, mean_y, conic_a, conic_b, conic_c, log_opacity] = sums<kPairGeometry>(0, begin, end).of;
    GaussianGradient<S> g = project_gaussian_backward(
        view.camera, t, p, ctx, ProjectedGradient<S>{mean_x, mean_y, conic_a, conic_b, conic_c, log_opacity});
    Vec3<S> grad_offset{S(0), S(0), S(0)};
    if (plan.colour) {
      const auto [red, green, blue] = sums<3>(kPairGeometry, begin, end).of;
      grad_offset = colour(row, offset, Vec3<S>{value[0], value[1], value[2]}, Vec3<S>{red, green, blue});
    }
    if (plan.depth) g.t.z += sums<1>(kPairGeometry + plan.count() - 1, begin, end).of[0];
    store(out.position, to, transpose(view.camera.rotation) * g.t + grad_offset);
    if (out.rotation) {
      S* o = out.rotation + to * 4;
      o[0] = g.rotation.x;
      o[1] = g.rotation.y;
      o[2] = g.rotation.z;
      o[3] = g.rotation.w;
    }
    store(out.log_scale, to, g.log_scale);
    if (out.logit_opacity) out.logit_opacity[to] = g.logit_opacity;
    if (out.mean_px) {
      out.mean_px[to * 2] = mean_x;
      out.mean_px[to * 2 + 1] = mean_y;
    }
  }
  NGS_HD static void store(S* column, std::int64_t i, Vec3<S> v) {
    if (column) {
      column[i * 3] = v.x;
      column[i * 3 + 1] = v.y;
      column[i * 3 + 2] = v.z;
    }
  }
  NGS_HD Vec3<S> colour(Row row, Vec3<S> offset, Vec3<S> rgb, Vec3<S> grad_rgb) const {
    const S* rest = cloud.sh_rest + row.i * cloud.rest_stride * 3;
    ShGradient<S> grad;
    const int degree = out.sh_rest ? cloud.sh_degree : 0;
    const Vec3<S> grad_offset = sh_colour_backward(degree, offset, rest, {rgb, grad_rgb}, grad);
    store(out.sh_dc, row.to, {grad.dc[0], grad.dc[1], grad.dc[2]});
    const int bands = (degree + 1) * (degree + 1) - 1;
    if (out.sh_rest)
      for (int k = 0; k < bands * 3; ++k) out.sh_rest[row.to * cloud.rest_stride * 3 + k] = grad.rest[k];
    return grad_offset;
  }
};

}  // namespace ngs
