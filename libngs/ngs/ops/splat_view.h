#pragma once
// One view of a cloud, projected and sorted into tiles: what the compositing loops run over. Internal to ops;
// templated on the storage scalar S (float in production, double and Dual in tests).
#include <algorithm>
#include <bit>
#include <vector>

#include "ngs/backend/for_each.h"
#include "ngs/backend/sort.h"
#include "ngs/ops/project_kernels.h"
#include "ngs/ops/splat.h"
#include "ngs/ops/splat_tiles.h"

namespace ngs {

inline constexpr double kTransmittanceStop = 1e-4;  // a pixel ends before its transmittance falls below

/// A cloud as arrays of S. Members as in GaussianCloud; null sh_dc: colour is not evaluated.
template <class S>
struct CloudView {
  std::int64_t size = 0;
  const S *position = nullptr, *rotation = nullptr, *log_scale = nullptr, *logit_opacity = nullptr;
  const S *sh_dc = nullptr, *sh_rest = nullptr;
  int sh_degree = 0;    // bands to evaluate
  int rest_stride = 0;  // coefficients stored per Gaussian
  const std::uint8_t *usable = nullptr, *include = nullptr;  // null: all
};

struct TileRect {
  std::uint16_t x_begin, x_end, y_begin, y_end;  // half open, in tiles
};

template <class S>
struct ProjectedView {
  std::vector<std::uint32_t> id;       // [V] ascending index into the cloud
  std::vector<SplatRecord<S>> record;  // [V]
  std::vector<S> depth;                // [V] camera z
  std::vector<TileRect> rect;          // [V] tiles the compat mode's radius reaches
};

/// Per tile the visible Gaussians that reach alpha >= 1/255 in it, nearest first.
/// Slots number the (Gaussian, tile) pairs Gaussian-major: the slots of visible Gaussian v are
/// [slot_begin[v], slot_begin[v + 1]), so that per-pair results are summed per Gaussian in a fixed order.
struct TileLists {
  int tiles_x = 0, tiles_y = 0;
  std::vector<std::int64_t> tile_begin;    // [tiles + 1]
  std::vector<std::uint32_t> visible;      // [pairs] index v
  std::vector<std::uint32_t> slot;         // [pairs]
  std::vector<std::int64_t> slot_begin;    // [V + 1]
  std::int64_t pairs() const { return std::int64_t(visible.size()); }
  std::int64_t tiles() const { return std::int64_t(tiles_x) * tiles_y; }
};

/// The camera in coordinates relative to `origin` (GaussianCloud::origin), with the Jacobian limits of gsplat,
/// which for a centred principal point are the 1.3 tan(fov/2) of 3DGS.
template <class S>
ProjectionCamera<S> projection_camera(const Camera& camera, const SplatOptions& options) {
  const double margin_x = 0.15 * camera.width_px / camera.fx, margin_y = 0.15 * camera.height_px / camera.fy;
  return {mat3_cast<S>(camera.rotation), S(camera.fx), S(camera.fy), S(camera.cx), S(camera.cy),
          S(-camera.cx / camera.fx - margin_x), S((camera.width_px - camera.cx) / camera.fx + margin_x),
          S(-camera.cy / camera.fy - margin_y), S((camera.height_px - camera.cy) / camera.fy + margin_y),
          S(options.compat == Compat::kInria ? 0.2 : 0.01), S(options.blur_px2)};
}

/// p - centre in the wide scalar: both may be far from the origin and close to each other.
template <class S>
Vec3<WideOf<S>> offset_from(const Vec3<double>& centre, const S* p) {
  using W = WideOf<S>;
  return {W(p[0]) - W(centre.x), W(p[1]) - W(centre.y), W(p[2]) - W(centre.z)};
}
template <class S, class W>
Vec3<S> narrowed(Vec3<W> v) { return {S(v.x), S(v.y), S(v.z)}; }

/// Rounds towards zero after clamping to [lo, hi]; NaN gives lo.
template <class S>
int clamped_int(S x, int lo, int hi) {
  const double v = double(x);
  return v > lo ? (v < hi ? int(v) : hi) : lo;
}

/// The tile rectangle of the chosen family: 3DGS takes 3 sigma of the longer axis, gsplat an opacity-aware
/// box per axis. Both visit whole tiles, which is where their results differ at tile borders.
template <class S>
TileRect tile_rect(const ProjectedGaussian<S>& p, Compat compat, int tiles_x, int tiles_y) {
  double radius_x, radius_y;
  const double xx = double(p.cov_xx), yy = double(p.cov_yy), det = double(p.det);
  if (compat == Compat::kInria) {
    const double mid = 0.5 * (xx + yy);
    radius_x = radius_y = std::ceil(3.0 * std::sqrt(mid + std::sqrt(std::max(0.1, mid * mid - det))));
  } else {
    const double extent = std::min(3.33, std::sqrt(2.0 * std::log(255.0 * double(p.opacity))));
    radius_x = std::ceil(extent * std::sqrt(xx)), radius_y = std::ceil(extent * std::sqrt(yy));
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
SplatRecord<S> record_of(const ProjectedGaussian<S>& p, WideOf<S> mean_x, WideOf<S> mean_y) {
  using std::log;
  using std::sqrt;
  const S two_cut = S(2) * log(S(255) * p.opacity);
  const S reach2 = max2(two_cut, S(0)), half_width = sqrt(reach2 * p.cov_xx), half_height = sqrt(reach2 * p.cov_yy);
  return {mean_x,    mean_y,         p.conic_a,  p.conic_b,   p.conic_c,
          p.opacity, two_cut,        S(1) / p.det, half_width, half_height,
          -p.conic_b / p.conic_a * half_height,  S(1) / p.conic_c};
}

/// Projects every Gaussian of the cloud; keeps those that can reach a pixel.
template <class S>
ProjectedView<S> project_view(const Exec& exec, const CloudView<S>& cloud, const Camera& camera,
                              const SplatOptions& options) {
  constexpr std::int64_t kChunk = 1 << 14;
  const ProjectionCamera<S> pc = projection_camera<S>(camera, options);
  const ProjectionCamera<WideOf<S>> wide = projection_camera<WideOf<S>>(camera, options);
  const Vec3<double> centre = camera.centre();
  const int tiles_x = (camera.width_px + kTilePx - 1) / kTilePx, tiles_y = (camera.height_px + kTilePx - 1) / kTilePx;
  const std::int64_t chunks = (cloud.size + kChunk - 1) / kChunk;
  std::vector<ProjectedView<S>> part(std::size_t(chunks), ProjectedView<S>{});
  for_each_task(exec, chunks, [&](std::int64_t chunk) {
    ProjectedView<S>& out = part[std::size_t(chunk)];
    for (std::int64_t i = chunk * kChunk; i < std::min(cloud.size, (chunk + 1) * kChunk); ++i) {
      if ((cloud.usable && !cloud.usable[i]) || (cloud.include && !cloud.include[i])) continue;
      const Vec3<WideOf<S>> t_wide = wide.rotation * offset_from(centre, cloud.position + i * 3);
      const Vec3<S> t = narrowed<S>(t_wide);
      if (!(t.z > pc.near_z)) continue;
      ProjectionContext<S> ctx;
      const ProjectedGaussian<S> p = project_gaussian(pc, t, cloud.rotation + i * 4, cloud.log_scale + i * 3,
                                                      cloud.logit_opacity[i], options.antialiased, ctx);
      if (!(p.opacity >= S(1.0 / 255)) || !(p.det > S(0)) || !std::isfinite(double(p.det)) ||
          !std::isfinite(double(p.mean_x)) || !std::isfinite(double(p.mean_y)))
        continue;
      const TileRect rect = tile_rect(p, options.compat, tiles_x, tiles_y);
      if (rect.x_begin >= rect.x_end || rect.y_begin >= rect.y_end) continue;
      out.id.push_back(std::uint32_t(i));
      out.record.push_back(record_of<S>(p, wide.f_x * (t_wide.x / t_wide.z) + wide.c_x,
                                        wide.f_y * (t_wide.y / t_wide.z) + wide.c_y));
      out.depth.push_back(t.z);
      out.rect.push_back(rect);
    }
  });
  ProjectedView<S> all;
  std::size_t visible = 0;
  for (const ProjectedView<S>& p : part) visible += p.id.size();
  all.id.reserve(visible), all.record.reserve(visible), all.depth.reserve(visible), all.rect.reserve(visible);
  for (ProjectedView<S>& p : part) {
    all.id.insert(all.id.end(), p.id.begin(), p.id.end());
    all.record.insert(all.record.end(), p.record.begin(), p.record.end());
    all.depth.insert(all.depth.end(), p.depth.begin(), p.depth.end());
    all.rect.insert(all.rect.end(), p.rect.begin(), p.rect.end());
    p = {};  // the whole is never held twice
  }
  return all;
}

/// Columns [x_lo, x_hi] (px, continuous) where the ellipse {quadratic form <= two_cut} meets the pixel-centre
/// rows [y_lo, y_hi]; false if it does not. Exact up to rounding: the widest row is where the ellipse's own
/// extreme point lies, or the band's edge nearest to it.
template <class S>
bool ellipse_columns(const SplatRecord<S>& g, double y_lo, double y_hi, double& x_lo, double& x_hi) {
  const double a = double(g.conic_a), b = double(g.conic_b), inv_det = double(g.inv_det);
  const double mean_x = double(g.mean_x), mean_y = double(g.mean_y), two_cut = double(g.two_cut);
  const double half_height = double(g.half_height) + kSpanSlackPx;
  const double v_lo = std::max(y_lo - mean_y, -half_height), v_hi = std::min(y_hi - mean_y, half_height);
  if (v_lo > v_hi) return false;
  const double v_right = -b * double(g.inv_c) * double(g.half_width);  // where the rightmost point lies
  const double inv_a = 1 / a;
  const auto row = [&](double v, double side) {
    return mean_x + inv_a * (side * std::sqrt(std::max(0.0, two_cut * a - v * v * inv_det)) - b * v);
  };
  x_hi = row(std::clamp(v_right, v_lo, v_hi), 1.0) + kSpanSlackPx;
  x_lo = row(std::clamp(-v_right, v_lo, v_hi), -1.0) - kSpanSlackPx;
  return true;
}

/// Tiles [first, end) of one row of tiles.
struct TileSpan {
  std::uint16_t first, end;
};

/// The tiles of row `ty` that visible Gaussian v reaches.
template <class S>
TileSpan tile_span(const ProjectedView<S>& view, std::size_t v, int ty) {
  const TileRect r = view.rect[v];
  double x_lo, x_hi;
  if (!ellipse_columns(view.record[v], ty * kTilePx + 0.5, ty * kTilePx + kTilePx - 0.5, x_lo, x_hi) || x_hi < 0.5)
    return {0, 0};
  // Pixel centres are at +0.5: column x is touched when x + 0.5 lies in [x_lo, x_hi].
  const int first = std::max(int(r.x_begin), clamped_int((x_lo - 0.5) / kTilePx, 0, r.x_end));
  const int last = std::min(int(r.x_end) - 1, clamped_int((x_hi - 0.5) / kTilePx, -1, r.x_end));
  if (last < first) return {0, 0};
  return {std::uint16_t(first), std::uint16_t(last + 1)};
}

/// Lists per tile, ordered by (depth, index): one global stable sort, then a stable counting sort into tiles.
template <class S>
TileLists bin_tiles(const Exec& exec, const ProjectedView<S>& view, int width_px, int height_px) {
  TileLists lists;
  lists.tiles_x = (width_px + kTilePx - 1) / kTilePx, lists.tiles_y = (height_px + kTilePx - 1) / kTilePx;
  const std::size_t count = view.id.size();
  std::vector<std::int64_t> span_begin(count + 1, 0);
  for (std::size_t v = 0; v < count; ++v)
    span_begin[v + 1] = span_begin[v] + view.rect[v].y_end - view.rect[v].y_begin;
  std::vector<TileSpan> span;
  span.resize(std::size_t(span_begin.back()));
  lists.slot_begin.assign(count + 1, 0);
  for_each_index(exec, std::int64_t(count), [&](std::int64_t row) {
    const auto v = std::size_t(row);
    std::int64_t tiles = 0;
    TileSpan* out = span.data() + span_begin[v];
    for (int ty = view.rect[v].y_begin; ty < view.rect[v].y_end; ++ty, ++out)
      *out = tile_span(view, v, ty), tiles += out->end - out->first;
    lists.slot_begin[v + 1] = tiles;
  });
  for (std::size_t v = 0; v < count; ++v) lists.slot_begin[v + 1] += lists.slot_begin[v];

  std::vector<std::uint32_t> order;
  {
    std::vector<std::uint32_t> key(count);
    for (std::size_t v = 0; v < count; ++v) key[v] = std::bit_cast<std::uint32_t>(float(double(view.depth[v])));
    order = stable_order(key);  // depths are positive: their bits sort like them
  }
  // Counting sort into tiles in `order`: each chunk of `order` owns its own range of every tile's list.
  const std::int64_t chunks = exec.threads, per_chunk = (std::int64_t(count) + chunks - 1) / chunks;
  std::vector<std::vector<std::int64_t>> next(std::size_t(chunks), std::vector<std::int64_t>(std::size_t(lists.tiles()), 0));
  const auto for_each_pair = [&](std::int64_t chunk, auto&& f) {
    for (std::int64_t k = chunk * per_chunk; k < std::min(std::int64_t(count), (chunk + 1) * per_chunk); ++k) {
      const std::uint32_t v = order[std::size_t(k)];
      std::int64_t slot = lists.slot_begin[v], row = std::int64_t(view.rect[v].y_begin) * lists.tiles_x;
      for (std::int64_t s = span_begin[v]; s < span_begin[v + 1]; ++s, row += lists.tiles_x)
        for (int tx = span[std::size_t(s)].first; tx < span[std::size_t(s)].end; ++tx) f(row + tx, v, slot++);
    }
  };
  for_each_task(exec, chunks, [&](std::int64_t chunk) {
    for_each_pair(chunk, [&](std::int64_t tile, std::uint32_t, std::int64_t) { ++next[std::size_t(chunk)][std::size_t(tile)]; });
  });
  lists.tile_begin.assign(std::size_t(lists.tiles()) + 1, 0);
  std::int64_t total = 0;
  for (std::size_t tile = 0; tile < std::size_t(lists.tiles()); ++tile) {
    lists.tile_begin[tile] = total;
    for (auto& n : next) {
      const std::int64_t mine = n[tile];
      n[tile] = total;
      total += mine;
    }
  }
  lists.tile_begin.back() = total;
  lists.visible.resize(std::size_t(total)), lists.slot.resize(std::size_t(total));
  for_each_task(exec, chunks, [&](std::int64_t chunk) {
    for_each_pair(chunk, [&](std::int64_t tile, std::uint32_t v, std::int64_t slot) {
      const auto at = std::size_t(next[std::size_t(chunk)][std::size_t(tile)]++);
      lists.visible[at] = v, lists.slot[at] = std::uint32_t(slot);
    });
  });
  return lists;
}

/// What the kernels of one tile are given.
template <class S>
TileWork<S> tile_work(const ProjectedView<S>& view, const TileLists& lists, std::int64_t tile, const Camera& camera,
                      Compat compat) {
  const auto begin = lists.tile_begin[std::size_t(tile)], end = lists.tile_begin[std::size_t(tile) + 1];
  const double stop = compat == Compat::kInria ? kTransmittanceStop : double(std::nextafter(float(kTransmittanceStop), 1.f));
  return {{int(tile % lists.tiles_x) * kTilePx, int(tile / lists.tiles_x) * kTilePx, camera.width_px, camera.height_px},
          view.record.data(), lists.visible.data() + begin, lists.slot.data() + begin, std::uint32_t(end - begin), S(stop)};
}

}  // namespace ngs
