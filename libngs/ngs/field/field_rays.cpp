// Rays of one view through the field, sampled here or read from a file of ngs-sample and ngs-rbf.
#include <algorithm>
#include <cmath>
#include <utility>

#include "ngs/core/error.h"
#include "ngs/field/joint_field.h"
#include "ngs/ops/neighbours/knn.h"

namespace ngs {
namespace {

/// The pixel grid whose nodes are `uv` [R, 2], row by row.
PixelGrid lattice(const std::vector<float>& uv, const QueryView& view) {
  PixelGrid grid;
  grid.rows = view.rows;
  grid.cols = view.cols;
  grid.first_x = uv[0];
  grid.first_y = uv[1];
  if (view.cols > 1) grid.step_x = (double(uv[std::size_t(view.cols - 1) * 2]) - grid.first_x) / (view.cols - 1);
  if (view.rows > 1) grid.step_y = (double(uv.back()) - grid.first_y) / (view.rows - 1);
  grid.beyond_x = grid.first_x - view.box.min_x;
  grid.beyond_y = grid.first_y - view.box.min_y;
  return grid;
}

}  // namespace

double field_reach(const SampleOptions& sample, const GaussianCloud& cloud, const std::vector<Camera>& cameras,
                   const BoundarySet& boundary) {
  double reach = 0;
  for (const Camera& camera : cameras)
    reach = std::max(reach, sample.depth_span * boundary_box(relative_to(camera, cloud.origin), boundary.positions(),
                                                             sample.bbox_pad_px, sample.world_unit)
                                                    .mean_distance);
  return reach;
}

const FieldRays& JointField::hold(const Exec& exec, FieldRays&& from, Rows<const float, 3> boundary) {
  RayQueries &to = rays_.rays, &rays = from.rays;
  to.grid = rays.grid;
  to.samples = rays.samples;
  const auto keep = [&](auto& values, auto& given) { results_.assign(values, std::move(given)); };
  keep(to.direction, rays.direction);
  keep(to.spacing, rays.spacing);
  keep(to.position, rays.position);
  keep(rays_.on_surface, from.on_surface);
  if (from.graph.neighbours == 0 && to.rays() > 0) {
    nearest_points(exec, boundary, to.positions(), shape_.neighbours, {rays_.graph, results_});
    return rays_;
  }
  rays_.graph.neighbours = from.graph.neighbours;
  rays_.graph.points = from.graph.points;
  keep(rays_.graph.index, from.graph.index);
  keep(rays_.graph.dist2, from.graph.dist2);
  keep(rays_.graph.row_begin, from.graph.row_begin);
  keep(rays_.graph.edge, from.graph.edge);
  return rays_;
}

FieldRays JointField::rays(const Exec& exec, const Camera& camera, const QueryField& field, std::size_t view,
                           const BoundarySet& boundary) const {
  FieldRays out;
  const QueryView& grid = field.views[view];
  const auto begin =
      std::size_t(std::lower_bound(field.view.begin(), field.view.end(), std::int32_t(view)) - field.view.begin());
  const auto end =
      std::size_t(std::upper_bound(field.view.begin(), field.view.end(), std::int32_t(view)) - field.view.begin());
  const auto samples = std::size_t(grid.depth_samples);
  if (begin == end) return out;
  if (end - begin != std::size_t(grid.rows) * std::size_t(grid.cols) * samples)
    throw Error(ErrorCode::kBadInput,
                "view '" + grid.name + "' of the field: " + std::to_string(end - begin) +
                    " queries, expected the whole grid of " +
                    std::to_string(std::size_t(grid.rows) * std::size_t(grid.cols) * samples),
                "sample again: ngs-sample scene.json boundary.ply -o queries.ply");
  RayQueries& rays = out.rays;
  rays.samples = grid.depth_samples;
  rays.position.assign(field.position.begin() + std::ptrdiff_t(begin * 3),
                       field.position.begin() + std::ptrdiff_t(end * 3));
  rays.depth.assign(field.depth.begin() + std::ptrdiff_t(begin), field.depth.begin() + std::ptrdiff_t(end));
  for (std::size_t q = begin; q < end; q += samples) {
    const double u = field.uv[q * 2], v = field.uv[q * 2 + 1];
    const Vec3<double> d =
        transpose(camera.rotation) * Vec3<double>{(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1.0};
    const double length = std::sqrt(dot(d, d));
    const double first = field.depth[q], last = field.depth[q + samples - 1];
    const double half = samples > 1 ? (last - first) / 2 : std::max(field.depth_span * first, field.depth_epsilon);
    rays.pixel.insert(rays.pixel.end(), {float(u), float(v)});
    rays.direction.insert(rays.direction.end(), {float(d.x / length), float(d.y / length), float(d.z / length)});
    rays.near.push_back(float(samples > 1 ? first : first - half));
    rays.far.push_back(float(samples > 1 ? last : first + half));
    rays.spacing.push_back(float(2 * half / double(std::max<std::size_t>(samples - 1, 1))));
  }
  rays.grid = lattice(rays.pixel, grid);
  if (recompute_neighbours_ || field.neighbours == 0) {
    out.graph = nearest_points(exec, boundary.positions(), rays.positions(), shape_.neighbours);
  } else {
    out.graph.neighbours = field.neighbours;
    out.graph.points = boundary.size();
    const auto k = std::size_t(field.neighbours);
    for (std::size_t i = begin * k; i < end * k; ++i) {
      const auto row = std::lower_bound(boundary.row.begin(), boundary.row.end(), field.neighbour[i]);
      if (row == boundary.row.end() || *row != field.neighbour[i])
        throw Error(ErrorCode::kInconsistent,
                    "the field has the neighbour Gaussian " + std::to_string(field.neighbour[i]) +
                        ", expected Gaussians of the boundary set",
                    "interpolate again: ngs-rbf boundary.ply queries.ply -o field.ply");
      out.graph.index.push_back(std::uint32_t(row - boundary.row.begin()));
    }
    build_transpose(out.graph);
  }
  return out;
}

void require_grids(const QueryField& field, const GaussianCloud& cloud, const std::string& name) {
  const auto bad = [&](const std::string& what) {
    throw Error(ErrorCode::kBadInput, name + ": " + what,
                "sample again: ngs-sample scene.json boundary.ply -o queries.ply");
  };
  const auto n = std::size_t(field.size());
  const std::pair<std::size_t, const char*> columns[] = {{field.uv.size() / 2, "u v"},
                                                         {field.view.size(), "view"},
                                                         {field.slot.size(), "slot"},
                                                         {field.depth.size(), "depth"}};
  for (const auto& [rows, column] : columns)
    if (rows != n) bad(std::string("no columns ") + column + ", expected those of ngs-sample");
  require_same_origin(field, cloud.origin);
  std::int32_t slot = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::int32_t before = i > 0 ? field.view[i - 1] : -1, view = field.view[i];
    slot = view == before ? slot + 1 : 0;
    if (view < before || field.slot[i] != slot)
      bad("row " + std::to_string(i) + " is slot " + std::to_string(field.slot[i]) + " of view " +
          std::to_string(view) + ", expected view by view all slots from 0");
    if (!std::isfinite(field.uv[2 * i]) || !std::isfinite(field.uv[2 * i + 1]) || !(field.depth[i] > 0))
      bad("row " + std::to_string(i) + " has no pixel or no depth, expected finite u v and depth > 0");
  }
}

}  // namespace ngs
