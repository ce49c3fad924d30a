#include "ngs/ops/splat/prepared/project_block.h"

#include <limits>

#include "ngs/backend/for_each.h"

namespace ngs {
namespace {

/// Rows of a block that are projected together: their columns fit the L1 cache.
constexpr int kPassRows = 64;

/// f(row) for the rows of a pass; f must treat them independently.
template <class F>
[[gnu::always_inline]] inline void each_row(const F& f) {
#ifdef __clang__
#pragma clang loop vectorize(assume_safety)
#else
#pragma GCC ivdep
#endif
  for (int i = 0; i < kPassRows; ++i) f(i);
}

/// One column of a pass.
template <class T>
struct alignas(64) Column {
  T of[kPassRows];
  [[gnu::always_inline]] T& operator[](int i) { return of[i]; }
  [[gnu::always_inline]] const T& operator[](int i) const { return of[i]; }
};

int count_of(const std::uint8_t* flag, int rows) {
  int count = 0;
  for (int i = 0; i < rows; ++i) count += flag[i];
  return count;
}

/// As tile_rect's rounding: v in tiles of 16 px, clamped to [0, hi]; NaN gives 0.
[[gnu::always_inline]] inline int clamped_tile(double v, int hi) {
  const double tile = v / kTilePx, above = tile > 0 ? tile : 0;
  return int(above < hi ? above : double(hi));
}

/// The rows of a pass before they enter ProjectedView; members as in ProjectedGaussian, SplatRecord and TileRect.
struct PassRows {
  Column<double> x, y, z;  // the centre in camera coordinates
  Column<float> depth, mean_x, mean_y, variance_x, variance_y, det_raw, det, conic_a, conic_b, conic_c;
  Column<float> opacity, max_mahalanobis2, log2_opacity;
  Column<float> along_u, along_v, across, inv_det, half_width, half_height, bottom_x, inv_c;
  Column<double> wide_x, wide_y, radius_x, radius_y;
  Column<int> x_begin, x_end, y_begin, y_end;
  std::array<Column<int>, kFirstRows> span_first, span_end;
  Column<int> reaches;
};

class BlockProjector {
  using View = ViewProjector<float>;

 public:
  BlockProjector(const PreparedCloud& cloud, const CloudView<float>& columns, const View& projector)
      : cloud_(cloud), columns_(columns), view_(projector) {}

  /// Whether a row within these bounds may reach a pixel.
  bool may_reach(const BlockBounds& bounds) const;
  /// Flags the rows that may reach a pixel; returns their number.
  int flag(std::int64_t block, std::uint8_t* reaches) const;
  /// Writes the flagged rows to `out`, starting at row `at`.
  void project(std::int64_t block, const std::uint8_t* reaches, std::size_t at, ProjectedView<float>& out) const;

 private:
  void flag_rows(std::size_t base, std::uint8_t* reaches) const;
  /// project() of the pass that begins at row `base`, all rows vectorised.
  void project_all(std::size_t base, const std::uint8_t* reaches, std::size_t at, ProjectedView<float>& out) const;
  /// The same row by row: faster where few are flagged.
  void project_few(std::size_t base, const std::uint8_t* reaches, std::size_t at, ProjectedView<float>& out) const;
  bool any_included(std::int64_t block) const;
  void to_camera(std::size_t base, PassRows& rows) const;
  void covariance(std::size_t base, PassRows& rows) const;
  void opacity(std::size_t base, const std::uint8_t* reaches, PassRows& rows) const;
  void radius(const std::uint8_t* reaches, PassRows& rows) const;
  void rectangle(PassRows& rows) const;
  void record(PassRows& rows) const;
  void span_of(int row, PassRows& rows) const;

  const PreparedCloud& cloud_;
  const CloudView<float>& columns_;
  const View& view_;
};

/// Evaluates the four linear forms of ViewProjector::outside_frustum at the corners of the box. A form that exceeds the
/// largest Gaussian's reach at all corners exceeds it at every centre.
bool BlockProjector::may_reach(const BlockBounds& bounds) const {
  if (bounds.empty()) return false;
  const auto& w = view_.wide;
  const TileRect& drawn = view_.drawn;
  const double far = std::numeric_limits<double>::infinity();
  double left = far, right = far, above = far, below = far, z_most = -far, z_least = far;
  for (int corner = 0; corner < 8; ++corner) {
    const float at[3] = {(corner & 1 ? bounds.hi : bounds.lo)[0], (corner & 2 ? bounds.hi : bounds.lo)[1],
                         (corner & 4 ? bounds.hi : bounds.lo)[2]};
    const Vec3<double> t = w.rotation * offset_from(view_.centre, at);
    const double column = w.f_x * t.x + w.c_x * t.z, row = w.f_y * t.y + w.c_y * t.z;
    const double slack = (View::kRadii * view_.blur_px + View::kRounding_px) * t.z;
    left = min2(left, kTilePx * drawn.x_begin * t.z - column - slack);
    right = min2(right, column - kTilePx * drawn.x_end * t.z - slack);
    above = min2(above, kTilePx * drawn.y_begin * t.z - row - slack);
    below = min2(below, row - kTilePx * drawn.y_end * t.z - slack);
    z_most = max2(z_most, t.z);
    z_least = min2(z_least, t.z);
  }
  if (!std::isfinite(left + right + above + below + z_most)) return true;
  const double reach = View::kRadii * double(bounds.scale) * view_.spread;
  return max2(max2(left, right), max2(above, below)) <= reach && float(z_most) > view_.camera.near_z &&
         float(z_least) < view_.far_z;
}

bool BlockProjector::any_included(std::int64_t block) const {
  if (columns_.include == nullptr) return true;
  const auto begin = std::size_t(block) * kBlockRows, end = std::min(cloud_.row.size(), begin + kBlockRows);
  std::uint8_t any = 0;
  for (std::size_t place = begin; place < end; ++place) any |= columns_.include[cloud_.row[place]];
  return any != 0;
}

int BlockProjector::flag(std::int64_t block, std::uint8_t* reaches) const {
  if (!may_reach(cloud_.bounds[std::size_t(block)]) || !any_included(block)) return 0;
  const std::size_t base = std::size_t(block) * kBlockRows;
  for (std::size_t pass = 0; pass < kBlockRows; pass += kPassRows) flag_rows(base + pass, reaches + pass);
  if (columns_.include != nullptr)
    for (std::size_t i = 0; i < std::min<std::size_t>(kBlockRows, cloud_.row.size() - base); ++i)
      reaches[i] &= std::uint8_t(columns_.include[cloud_.row[base + i]] != 0);
  return count_of(reaches, kBlockRows);
}

void BlockProjector::flag_rows(std::size_t base, std::uint8_t* reaches) const {
  PassRows rows;
  to_camera(base, rows);
  const float *scale = &cloud_.scale_bound[base], *opacity = &cloud_.opacity[base];
  const auto w = view_.wide;
  const double spread = view_.spread, blur_px = view_.blur_px;
  const double x_lo = kTilePx * view_.drawn.x_begin, x_hi = kTilePx * view_.drawn.x_end;
  const double y_lo = kTilePx * view_.drawn.y_begin, y_hi = kTilePx * view_.drawn.y_end;
  const float near_z = view_.camera.near_z, far_z = view_.far_z;
  each_row([=, &rows](int i) {
    const double z = rows.z[i], column = w.f_x * rows.x[i] + w.c_x * z, row = w.f_y * rows.y[i] + w.c_y * z;
    const double off = max2(max2(x_lo * z - column, column - x_hi * z), max2(y_lo * z - row, row - y_hi * z));
    const double reach = View::kRadii * (double(scale[i]) * spread + blur_px * z) + View::kRounding_px * z;
    rows.reaches[i] = !(off > reach) & (float(z) > near_z) & (float(z) < far_z) & (opacity[i] >= float(kAlphaMin));
  });
  for (int i = 0; i < kPassRows; ++i) reaches[i] = std::uint8_t(rows.reaches[i]);
}

void BlockProjector::to_camera(std::size_t base, PassRows& rows) const {
  const float *x = &cloud_.position[0][base], *y = &cloud_.position[1][base], *z = &cloud_.position[2][base];
  const Vec3<double> centre = view_.centre;
  const Mat3<double> r = view_.wide.rotation;
  each_row([&rows, x, y, z, centre, r](int i) {
    const Vec3<double> t = r * Vec3<double>{double(x[i]) - centre.x, double(y[i]) - centre.y, double(z[i]) - centre.z};
    rows.x[i] = t.x;
    rows.y[i] = t.y;
    rows.z[i] = t.z;
  });
}

/// project_gaussian without the opacity.
void BlockProjector::covariance(std::size_t base, PassRows& rows) const {
  const float* m[9];
  for (std::size_t k = 0; k < 9; ++k) m[k] = &cloud_.shape[k][base];
  const float *m0 = m[0], *m1 = m[1], *m2 = m[2], *m3 = m[3], *m4 = m[4], *m5 = m[5], *m6 = m[6], *m7 = m[7],
              *m8 = m[8];
  const ProjectionCamera<float> c = view_.camera;
  each_row([=, &rows](int i) {
    const float z = float(rows.z[i]), slope_x = float(rows.x[i]) / z, slope_y = float(rows.y[i]) / z;
    const float j00 = c.f_x / z, j11 = c.f_y / z;
    const float j02 = -j00 * clamp3(slope_x, c.x_lo, c.x_hi), j12 = -j11 * clamp3(slope_y, c.y_lo, c.y_hi);
    const float* r = c.rotation.m;
    const Vec3<float> u0 = j00 * vec3(r) + j02 * vec3(r + 6), u1 = j11 * vec3(r + 3) + j12 * vec3(r + 6);
    const auto times_shape = [&](const Vec3<float>& u) {
      return Vec3<float>{m0[i] * u.x + m3[i] * u.y + m6[i] * u.z, m1[i] * u.x + m4[i] * u.y + m7[i] * u.z,
                         m2[i] * u.x + m5[i] * u.y + m8[i] * u.z};
    };
    const Vec3<float> v0 = times_shape(u0), v1 = times_shape(u1), v_cross = cross(v0, v1);
    const float xx = dot(v0, v0), xy = dot(v0, v1), yy = dot(v1, v1), det_raw = dot(v_cross, v_cross);
    const float det = det_raw + c.blur * (xx + yy) + c.blur * c.blur;
    rows.depth[i] = z;
    rows.mean_x[i] = c.f_x * slope_x + c.c_x;
    rows.mean_y[i] = c.f_y * slope_y + c.c_y;
    rows.variance_x[i] = xx + c.blur;
    rows.variance_y[i] = yy + c.blur;
    rows.det_raw[i] = det_raw;
    rows.det[i] = det;
    rows.conic_a[i] = (yy + c.blur) / det;
    rows.conic_b[i] = -xy / det;
    rows.conic_c[i] = (xx + c.blur) / det;
  });
}

void BlockProjector::opacity(std::size_t base, const std::uint8_t* reaches, PassRows& rows) const {
  const float *opacity = &cloud_.opacity[base], *max_mahalanobis2 = &cloud_.max_mahalanobis2[base],
              *log2 = &cloud_.log2_opacity[base];
  each_row([&rows, opacity, max_mahalanobis2, log2](int i) {
    rows.opacity[i] = opacity[i];
    rows.max_mahalanobis2[i] = max_mahalanobis2[i];
    rows.log2_opacity[i] = log2[i];
  });
  if (!view_.camera.antialiased) return;
  for (int i = 0; i < kPassRows; ++i) {
    if (!reaches[i]) continue;
    rows.opacity[i] *= std::sqrt(max2(rows.det_raw[i] / rows.det[i], float(kCompensationFloor2)));
    rows.max_mahalanobis2[i] = max_mahalanobis2_of(rows.opacity[i]);
    rows.log2_opacity[i] = log2_opacity_of(rows.opacity[i]);
  }
}

/// The radii of tile_rect.
void BlockProjector::radius(const std::uint8_t* reaches, PassRows& rows) const {
  if (view_.compat == Compat::kInria)
    return each_row([&rows](int i) {
      const double xx = rows.variance_x[i], yy = rows.variance_y[i], det = rows.det[i], mid = 0.5 * (xx + yy);
      rows.radius_x[i] = std::ceil(3.0 * std::sqrt(mid + std::sqrt(max2(0.1, mid * mid - det))));
      rows.radius_y[i] = rows.radius_x[i];
    });
  for (int i = 0; i < kPassRows; ++i) {
    const double extent = reaches[i] ? tile_extent(double(rows.opacity[i])) : 0.0;
    rows.radius_x[i] = std::ceil(extent * std::sqrt(double(rows.variance_x[i])));
    rows.radius_y[i] = std::ceil(extent * std::sqrt(double(rows.variance_y[i])));
  }
}

void BlockProjector::rectangle(PassRows& rows) const {
  const double shift = view_.compat == Compat::kInria ? 0.5 : 0.0;
  const int tiles_x = view_.tiles_x, tiles_y = view_.tiles_y;
  const auto w = view_.wide;
  each_row([&rows, shift, tiles_x, tiles_y, w](int i) {
    constexpr double kRoundUp = kTilePx - 1;
    const double x = double(rows.mean_x[i]) - shift, y = double(rows.mean_y[i]) - shift;
    const double radius_x = rows.radius_x[i], radius_y = rows.radius_y[i];
    rows.x_begin[i] = clamped_tile(x - radius_x, tiles_x);
    rows.x_end[i] = clamped_tile(x + radius_x + kRoundUp, tiles_x);
    rows.y_begin[i] = clamped_tile(y - radius_y, tiles_y);
    rows.y_end[i] = clamped_tile(y + radius_y + kRoundUp, tiles_y);
    rows.wide_x[i] = w.f_x * (rows.x[i] / rows.z[i]) + w.c_x;
    rows.wide_y[i] = w.f_y * (rows.y[i] / rows.z[i]) + w.c_y;
  });
}

/// As record_of; also sets whether the row reaches a pixel.
void BlockProjector::record(PassRows& rows) const {
  each_row([&rows](int i) {
    constexpr float kMaxFinite = std::numeric_limits<float>::max();
    const auto form = PowerForm<float>::of(rows.conic_a[i], rows.conic_b[i], rows.variance_y[i]);
    const float reach2 = max2(rows.max_mahalanobis2[i], 0.f), half_height = std::sqrt(reach2 * rows.variance_y[i]);
    rows.along_u[i] = form.along_u;
    rows.along_v[i] = form.along_v;
    rows.across[i] = form.across;
    rows.inv_det[i] = 1.f / rows.det[i];
    rows.inv_c[i] = 1.f / rows.conic_c[i];
    rows.half_width[i] = std::sqrt(reach2 * rows.variance_x[i]);
    rows.half_height[i] = half_height;
    rows.bottom_x[i] = -rows.conic_b[i] / rows.conic_a[i] * half_height;
    rows.reaches[i] = (rows.opacity[i] >= float(kAlphaMin)) & (rows.det[i] > 0.f) & (rows.det[i] <= kMaxFinite) &
                      (std::fabs(rows.mean_x[i]) <= kMaxFinite) & (std::fabs(rows.mean_y[i]) <= kMaxFinite) &
                      (rows.x_begin[i] < rows.x_end[i]) & (rows.y_begin[i] < rows.y_end[i]);
  });
}

/// As first_spans: the tiles of one row, counted from the rectangle's first.
void BlockProjector::span_of(int row, PassRows& rows) const {
  Column<int>&first = rows.span_first[std::size_t(row)], &end = rows.span_end[std::size_t(row)];
  each_row([&rows, &first, &end, row](int i) {
    const PowerForm<float> form{rows.along_u[i], rows.along_v[i], rows.across[i]};
    const EllipseShape<float> shape{form.a(),      form.b(),           rows.max_mahalanobis2[i], rows.inv_det[i],
                                    rows.inv_c[i], rows.half_width[i], rows.half_height[i]};
    const int ty = rows.y_begin[i] + row;
    const TileRange range = tiles_of_row(shape, rows.wide_x[i], rows.wide_y[i], {rows.x_begin[i], rows.x_end[i]}, ty);
    const bool shown = (rows.reaches[i] != 0) & (ty < rows.y_end[i]);
    first[i] = shown ? range.first : 0;
    end[i] = shown ? range.end : 0;
  });
}

void BlockProjector::project_all(std::size_t base, const std::uint8_t* reaches, std::size_t at,
                                 ProjectedView<float>& out) const {
  PassRows rows;
  to_camera(base, rows);
  covariance(base, rows);
  opacity(base, reaches, rows);
  radius(reaches, rows);
  rectangle(rows);
  record(rows);
  for (int row = 0; row < kFirstRows; ++row) span_of(row, rows);
  const auto half = [](int tiles) { return std::uint16_t(tiles); };
  for (int i = 0; i < kPassRows; ++i) {
    if (!reaches[i]) continue;
    out.id[at] = cloud_.row[base + std::size_t(i)];
    out.depth[at] = rows.depth[i];
    out.rect[at] = rows.reaches[i] ? TileRect{half(rows.x_begin[i]), half(rows.x_end[i]), half(rows.y_begin[i]),
                                              half(rows.y_end[i])}
                                   : TileRect{0, 0, 0, 0};
    for (std::size_t row = 0; row < rows.span_first.size(); ++row)
      out.first[at][row] = {half(rows.span_first[row][i]), half(rows.span_end[row][i])};
    out.record[at] = {
        rows.wide_x[i],       rows.wide_y[i],           {rows.along_u[i], rows.along_v[i], rows.across[i]},
        rows.log2_opacity[i], rows.max_mahalanobis2[i], rows.inv_det[i],
        rows.half_width[i],   rows.half_height[i],      rows.bottom_x[i],
        rows.inv_c[i]};
    ++at;
  }
}

void BlockProjector::project_few(std::size_t base, const std::uint8_t* reaches, std::size_t at,
                                 ProjectedView<float>& out) const {
  for (int i = 0; i < kPassRows; ++i) {
    if (!reaches[i]) continue;
    VisibleGaussian<float> g{};
    out.id[at] = cloud_.row[base + std::size_t(i)];
    if (!view_.project(columns_, std::int64_t(out.id[at]), g)) g = {};
    out.record[at] = g.record;
    out.depth[at] = g.depth;
    out.rect[at] = g.rect;
    out.first[at] = first_spans(g.record, g.rect);
    ++at;
  }
}

void BlockProjector::project(std::int64_t block, const std::uint8_t* reaches, std::size_t at,
                             ProjectedView<float>& out) const {
  constexpr int kFew = 12;  // flagged rows of a pass below which they are projected one by one
  for (int pass = 0; pass < kBlockRows; pass += kPassRows, reaches += kPassRows) {
    const std::size_t base = std::size_t(block) * kBlockRows + std::size_t(pass);
    const int count = count_of(reaches, kPassRows);
    if (count >= kFew)
      project_all(base, reaches, at, out);
    else if (count > 0)
      project_few(base, reaches, at, out);
    at += std::size_t(count);
  }
}

}  // namespace

void project_blocks(const Exec& exec, const PreparedCloud& cloud, const CloudView<float>& columns,
                    const ViewProjector<float>& projector, ViewScratch<float>& memory) {
  const BlockProjector blocks(cloud, columns, projector);
  const auto in_blocks_of = [&](std::int64_t group, const auto& f) {
    for (std::int64_t b = group * kGroupBlocks; b < std::min(cloud.blocks(), (group + 1) * kGroupBlocks); ++b)
      f(std::size_t(b), memory.reaches.data() + b * kBlockRows);
  };
  memory.reaches.resize(std::size_t(cloud.blocks()) * kBlockRows);
  memory.first.resize(std::size_t(cloud.blocks()) + 1);
  for_each_task(exec, cloud.groups(), [&](std::int64_t group) {
    const bool some = blocks.may_reach(cloud.group_bounds[std::size_t(group)]);
    in_blocks_of(group, [&](std::size_t b, std::uint8_t* reaches) {
      memory.first[b + 1] = some ? blocks.flag(std::int64_t(b), reaches) : 0;
    });
  });
  memory.first[0] = 0;
  for (std::size_t b = 0; b + 1 < memory.first.size(); ++b) memory.first[b + 1] += memory.first[b];
  const auto visible = std::size_t(memory.first.back());
  ProjectedView<float>& out = memory.view;
  out.id.resize(visible);
  out.record.resize(visible);
  out.depth.resize(visible);
  out.rect.resize(visible);
  out.first.resize(visible);
  for_each_task(exec, cloud.groups(), [&](std::int64_t group) {
    in_blocks_of(group, [&](std::size_t b, const std::uint8_t* reaches) {
      if (memory.first[b] < memory.first[b + 1])
        blocks.project(std::int64_t(b), reaches, std::size_t(memory.first[b]), out);
    });
  });
}

}  // namespace ngs
