#pragma once
// Projects one view of a cloud and bins it into tiles, the input of the compositing loops. Internal to ops; templated
// on the storage scalar S (float in production, double and Dual in tests).
#include <algorithm>
#include <vector>

#include "ngs/backend/for_each.h"
#include "ngs/ops/splat/splat_gaussian.h"
#include "ngs/ops/splat/splat_tiles.h"
#include "ngs/ops/splat/tile_lists.h"

namespace ngs {

/// Projects the cloud; returns the Gaussians that can reach a pixel.
template <class S>
ProjectedView<S> project_view(const Exec& exec, const CloudView<S>& cloud, const ViewProjector<S>& projector) {
  constexpr std::int64_t kChunk = 1 << 11;
  const std::int64_t chunks = (cloud.size + kChunk - 1) / kChunk;
  std::vector<ProjectedView<S>> part(std::size_t(chunks), ProjectedView<S>{});
  for_each_task(exec, chunks, [&](std::int64_t chunk) {
    ProjectedView<S>& out = part[std::size_t(chunk)];
    const std::int64_t begin = chunk * kChunk, count = std::min(cloud.size - begin, kChunk);
    std::uint8_t outside[kChunk];
    // A loop of its own, so that the compiler vectorises it.
    for (std::int64_t k = 0; k < count; ++k) outside[k] = projector.outside_frustum(cloud, begin + k);
    for (std::int64_t i = begin; i < begin + count; ++i) {
      VisibleGaussian<S> g;
      if (outside[i - begin] || !projector.project(cloud, i, g)) continue;
      out.id.push_back(std::uint32_t(i));
      out.record.push_back(g.record);
      out.depth.push_back(g.depth);
      out.rect.push_back(g.rect);
      out.first.push_back(first_spans(g.record, g.rect));
    }
  });
  ProjectedView<S> all;
  std::size_t visible = 0;
  for (const ProjectedView<S>& p : part) visible += p.id.size();
  all.reserve(visible);
  for (ProjectedView<S>& p : part) {
    all.append(p);
    p = {};  // free each part once copied, so that the view is not in memory twice
  }
  return all;
}

/// The input of the kernels of one tile.
template <class S>
TileWork<S> tile_work(const ProjectedView<S>& view, const TileLists& lists, std::int64_t tile, const Camera& camera,
                      Compat compat) {
  const auto begin = lists.tile_begin[std::size_t(tile)], end = lists.tile_begin[std::size_t(tile) + 1];
  return {{int(tile % lists.tiles_x) * kTilePx, int(tile / lists.tiles_x) * kTilePx, camera.width_px, camera.height_px},
          view.record.data(),
          lists.visible.data() + begin,
          lists.slot.data() + begin,
          std::uint32_t(end - begin),
          S(transmittance_stop(compat))};
}

}  // namespace ngs
