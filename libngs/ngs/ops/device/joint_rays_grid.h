#pragma once
// Box, grid, rays and query points of a view on a device. How many nodes the grid has is known there only: arrays have room
// for the most there can be, and rays beyond the grid lie at one point, are not on the surface, and get no gradient.
//                                                                                     Eqs. (4)-(7)
#include "ngs/ops/device/device_joint.h"
#include "ngs/ops/device/knn_schedule.h"
#include "ngs/ops/field/sample_grid.h"

namespace ngs {

/// The grid of a view, where the number of its nodes matters.
struct ViewGrid {
  PixelGrid grid;
  double mean_distance;
  NGS_HD std::int64_t queries(int samples) const { return grid.nodes() * samples; }
};

/// A kernel whose members are completed from what the device has computed: set(kernel) before each call.
template <class Kernel, class Set>
struct Completed {
  static constexpr const char* kName = Kernel::kName;
  Kernel kernel;
  Set set;
  NGS_HD void operator()(std::int64_t i) const {
    Kernel here = kernel;
    set(here);
    here(i);
  }
};

struct GatherPositions {
  static constexpr const char* kName = "gather_positions";
  const std::uint32_t* row;  // [B]
  const float* position;     // [N, 3]
  float* out;                // [B, 3]
  NGS_HD void operator()(std::int64_t b) const {
    for (int a = 0; a < 3; ++a) out[b * 3 + a] = position[std::int64_t(row[b]) * 3 + a];
  }
};

struct BoxOfChunk {
  static constexpr const char* kName = "box_of_chunk";
  static constexpr std::int64_t kRows = 256;
  RayCamera camera;
  Rows<const float, 3> boundary;
  double pad_px;
  BoxSums* sums;  // [chunks] out
  NGS_HD void operator()(std::int64_t chunk) const {
    BoxSums total;
    for (std::int64_t j = chunk * kRows; j < min2(boundary.n, (chunk + 1) * kRows); ++j) {
      const float* p = boundary.row(j);
      total.add(camera, {double(p[0]), double(p[1]), double(p[2])}, pad_px);
    }
    sums[chunk] = total;
  }
};

struct GridOfBox {
  static constexpr const char* kName = "grid_of_box";
  RayCamera camera;
  const BoxSums* sums;
  std::int64_t chunks;
  double pad_px;
  GridShape shape;
  bool whole_image;
  ViewGrid* out;
  NGS_HD void operator()(std::int64_t) const {
    BoxSums total;
    for (std::int64_t c = 0; c < chunks; ++c) total.add(sums[c]);
    const BoundaryBox box = boundary_box(camera, total, pad_px);
    const PixelBox image{0, 0, double(camera.width_px), double(camera.height_px)};
    *out = {pixel_grid(whole_image && box.visible > 0 ? image : box.box, shape), box.mean_distance};
  }
};

struct SampleRayOfView {
  static constexpr const char* kName = "sample_ray";
  SampleRay kernel;
  const ViewGrid* view;
  NGS_HD void operator()(std::int64_t r) const {
    if (r >= view->grid.nodes()) return beside(r);
    SampleRay here = kernel;
    here.grid = view->grid, here.options.mean_distance = view->mean_distance;
    here(r);
  }

 private:
  NGS_HD void beside(std::int64_t r) const {
    const RayArrays& out = kernel.out;
    const float d[3] = {0, 0, 1};
    const Vec3<double> c = kernel.camera.centre;
    const float p[3] = {float(c.x), float(c.y), float(c.z)};
    out.near[r] = out.far[r] = out.spacing[r] = 0;
    for (int a = 0; a < 3; ++a) out.direction[r * 3 + a] = d[a];
    for (std::int64_t i = r * kernel.options.samples * 3; i < (r + 1) * kernel.options.samples * 3; ++i)
      out.position[i] = p[i % 3];
  }
};

struct RayOfViewOnSurface {
  static constexpr const char* kName = "ray_on_surface";
  RayOnSurface kernel;
  const ViewGrid* view;
  NGS_HD void operator()(std::int64_t r) const {
    kernel.on[r] = 0;
    if (r >= view->grid.nodes()) return;
    RayOnSurface here = kernel;
    here.grid = view->grid;
    here(r);
  }
};

/// Of rays: [R, 3] and [R].
template <class T>
struct RayValues {
  T *colour, *alpha;
};

/// The rays of one step.
template <class Grid>
struct RaysOnGrid {
  using Floats = DeviceBuffer<Grid, float>;
  std::int64_t rays = 0;  // that there is room for
  int samples = 0;
  DeviceBuffer<Grid, ViewGrid> view;
  Floats direction, near, far, spacing, position;
  DeviceBuffer<Grid, std::uint8_t> on_surface;
  GraphOnGrid<Grid> graph;

  Rows<const float, 3> positions() const { return {position.data(), rays * samples}; }
};

/// About `boundary` [B, 3] as it is; `map`: null members: windows are centred on the mean distance.
template <class Grid>
RaysOnGrid<Grid> sampled_rays(Grid& grid, const JointProblem& p, const RayCamera& camera, Rows<const float, 3> boundary,
                              const DepthPlanes& map) {
  RaysOnGrid<Grid> out;
  const std::int64_t n = out.rays = p.shape.most_nodes(), chunks = divided_up(boundary.n, BoxOfChunk::kRows);
  out.samples = p.rays.samples;
  out.view = {grid, 1}, out.direction = {grid, n * 3}, out.near = {grid, n}, out.far = {grid, n}, out.spacing = {grid, n};
  out.position = {grid, n * out.samples * 3}, out.on_surface = {grid, n};
  const DeviceBuffer<Grid, BoxSums> sums(grid, chunks);
  grid.each(chunks, BoxOfChunk{camera, boundary, p.bbox_pad_px, sums.data()});
  grid.each(1, GridOfBox{camera, sums.data(), chunks, p.bbox_pad_px, p.shape, p.terms.whole_image, out.view.data()});
  const RayArrays arrays{nullptr,          out.direction.data(), out.near.data(), out.far.data(),
                         out.spacing.data(), out.position.data(), nullptr};
  grid.each(n, SampleRayOfView{{camera, {}, p.rays, map, arrays}, out.view.data()});
  out.graph = nearest_on_grid(grid, boundary, out.positions(), p.field->neighbours, false);
  return out;
}

/// Those of an artifact. No rays: no boundary in the view.
template <class Grid>
RaysOnGrid<Grid> given_rays(Grid& grid, const JointRays& given) {
  const RayQueries& r = *given.rays;
  const KnnGraph& g = *given.graph;
  RaysOnGrid<Grid> out;
  out.rays = r.rays(), out.samples = r.samples;
  const ViewGrid view{r.grid, 0};
  out.view = {grid, &view, 1};
  out.direction = {grid, r.direction}, out.near = {grid, r.near}, out.far = {grid, r.far};
  out.spacing = {grid, r.spacing}, out.position = {grid, r.position}, out.on_surface = {grid, out.rays};
  out.graph.neighbours = g.neighbours, out.graph.points = g.points, out.graph.queries = g.queries();
  out.graph.index = {grid, g.index};
  out.graph.row_begin = {grid, g.row_begin}, out.graph.edge = {grid, g.edge};
  return out;
}

}  // namespace ngs
