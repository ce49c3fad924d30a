#pragma once
// One view of a cloud, projected and sorted into tiles: what the compositing loops run over. Internal to ops;
// templated on the storage scalar S (float in production, double and Dual in tests).
#include <algorithm>
#include <bit>
#include <vector>

#include "ngs/backend/for_each.h"
#include "ngs/backend/sort.h"
#include "ngs/core/check.h"
#include "ngs/ops/splat/splat_gaussian.h"
#include "ngs/ops/splat/splat_tiles.h"

namespace ngs {

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

/// Projects every Gaussian of the cloud; keeps those that can reach a pixel.
template <class S>
ProjectedView<S> project_view(const Exec& exec, const CloudView<S>& cloud, const Camera& camera,
                              const SplatOptions& options) {
  constexpr std::int64_t kChunk = 1 << 11;
  const ViewProjector<S> projector = view_projector<S>(camera, options);
  const std::int64_t chunks = (cloud.size + kChunk - 1) / kChunk;
  std::vector<ProjectedView<S>> part(std::size_t(chunks), ProjectedView<S>{});
  for_each_task(exec, chunks, [&](std::int64_t chunk) {
    ProjectedView<S>& out = part[std::size_t(chunk)];
    const std::int64_t begin = chunk * kChunk, count = std::min(cloud.size - begin, kChunk);
    std::uint8_t beside[kChunk];
    for (std::int64_t k = 0; k < count; ++k) beside[k] = projector.beside(cloud, begin + k);
    for (std::int64_t i = begin; i < begin + count; ++i) {
      VisibleGaussian<S> g;
      if (beside[i - begin] || !projector.project(cloud, i, g)) continue;
      out.id.push_back(std::uint32_t(i));
      out.record.push_back(g.record), out.depth.push_back(g.depth), out.rect.push_back(g.rect);
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

/// The tiles of row `ty` that visible Gaussian v reaches.
template <class S>
TileSpan tile_span(const ProjectedView<S>& view, std::size_t v, int ty) {
  return tile_span(view.record[v], view.rect[v], ty);
}

/// Where the pairs of one visible Gaussian go: what the sort into tiles reads of it, in one place, since it comes there in
/// order of depth, which is no order in memory.
struct TilePairs {
  std::int64_t slot;  // of the first
  std::int64_t span;  // of its first row of tiles
  std::uint16_t first_row, rows;
  TileSpan first;  // of that row: most Gaussians have no other
};

/// The visible Gaussians nearest first; equal depths by index.
template <class S>
std::vector<std::uint32_t> depth_order(const ProjectedView<S>& view) {
  std::vector<std::uint32_t> key(view.depth.size());
  for (std::size_t v = 0; v < key.size(); ++v) key[v] = std::bit_cast<std::uint32_t>(float(double(view.depth[v])));
  return stable_order(key);  // depths are positive: their bits sort like them
}

/// Lists per tile, ordered by (depth, index): one global stable sort, then a stable counting sort into tiles.
template <class S>
TileLists bin_tiles(const Exec& exec, const ProjectedView<S>& view, int width_px, int height_px) {
  constexpr std::int64_t kAhead = 16;  // what the sort asks memory for before it needs it
  TileLists lists;
  lists.tiles_x = (width_px + kTilePx - 1) / kTilePx, lists.tiles_y = (height_px + kTilePx - 1) / kTilePx;
  const std::size_t count = view.id.size();
  std::vector<TilePairs> pairs(count);
  std::int64_t rows = 0;
  for (std::size_t v = 0; v < count; ++v) {
    const TileRect& r = view.rect[v];
    pairs[v] = {0, rows, std::uint16_t(r.y_begin), std::uint16_t(r.y_end - r.y_begin), {}};
    rows += pairs[v].rows;
  }
  std::vector<TileSpan> span;
  span.resize(std::size_t(rows));
  lists.slot_begin.assign(count + 1, 0);
  for_each_index(exec, std::int64_t(count), [&](std::int64_t row) {
    const auto v = std::size_t(row);
    std::int64_t tiles = 0;
    TileSpan* out = span.data() + pairs[v].span;
    for (int ty = view.rect[v].y_begin; ty < view.rect[v].y_end; ++ty, ++out)
      *out = tile_span(view, v, ty), tiles += out->end - out->first;
    lists.slot_begin[v + 1] = tiles;
    if (pairs[v].rows > 0) pairs[v].first = span[std::size_t(pairs[v].span)];
  });
  for (std::size_t v = 0; v < count; ++v)
    lists.slot_begin[v + 1] += lists.slot_begin[v], pairs[v].slot = lists.slot_begin[v];

  // Counting sort into tiles in `order`: each chunk of `order` owns its own range of every tile's list.
  const std::vector<std::uint32_t> order = depth_order(view);
  const std::int64_t chunks = exec.threads, per_chunk = (std::int64_t(count) + chunks - 1) / chunks;
  std::vector<std::vector<std::int64_t>> next(std::size_t(chunks), std::vector<std::int64_t>(std::size_t(lists.tiles()), 0));
  const auto for_each_pair = [&](std::int64_t chunk, auto&& f) {
    const std::int64_t end = std::min(std::int64_t(count), (chunk + 1) * per_chunk);
    for (std::int64_t k = chunk * per_chunk; k < end; ++k) {
      __builtin_prefetch(&pairs[order[std::size_t(std::min(k + kAhead, end - 1))]]);
      const std::uint32_t v = order[std::size_t(k)];
      const TilePairs p = pairs[v];
      std::int64_t slot = p.slot, row = std::int64_t(p.first_row) * lists.tiles_x;
      for (std::int64_t s = 0; s < p.rows; ++s, row += lists.tiles_x) {
        const TileSpan columns = s == 0 ? p.first : span[std::size_t(p.span + s)];
        for (int tx = columns.first; tx < columns.end; ++tx) f(row + tx, v, slot++);
      }
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
  NGS_CHECK(total <= 0xffffffff, "slots are counted in 32 bits");
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
  return {{int(tile % lists.tiles_x) * kTilePx, int(tile / lists.tiles_x) * kTilePx, camera.width_px, camera.height_px},
          view.record.data(), lists.visible.data() + begin, lists.slot.data() + begin,
          std::uint32_t(end - begin), S(transmittance_stop(compat))};
}

}  // namespace ngs
