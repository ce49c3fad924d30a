#pragma once
// Projection and binning of one view from its camera, for tests and benchmarks of the splat ops.
#include "ngs/ops/splat/splat_view.h"

namespace ngs {

template <class S>
ProjectedView<S> project_view(const Exec& exec, const CloudView<S>& cloud, const Camera& camera,
                              const SplatOptions& options) {
  return project_view(exec, cloud, view_projector<S>(camera, options));
}

/// Tile lists in depth order: (depth, index).
template <class S>
TileLists bin_tiles(const Exec& exec, const ProjectedView<S>& view, int width_px, int height_px) {
  TileLists lists;
  BinScratch scratch;
  lists.tiles_x = tiles_across(width_px);
  lists.tiles_y = tiles_across(height_px);
  bin_tiles(exec, view, lists, scratch);
  return lists;
}

}  // namespace ngs
