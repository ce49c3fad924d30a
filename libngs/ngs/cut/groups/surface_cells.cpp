#include "ngs/cut/groups/surface_cells.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "ngs/backend/for_each.h"
#include "ngs/math/median.h"
#include "ngs/scene/geometry/unproject.h"

namespace ngs {
namespace {

using V = Vec3<double>;

constexpr float kStep =
    0.02f;  // depth step: relative second difference of the inverse depth between neighbouring pixels above this
constexpr int kNormalReach_px = 2;
constexpr double kBehind = 3;  // sides of a cell: a view with a surface farther behind a cell sees through it

/// The surface in one cell, summed over one view or over all views.
struct ShownCell {
  std::uint64_t key = 0;
  V position{0, 0, 0}, normal{0, 0, 0}, colour{0, 0, 0};  // sums over points
  std::int64_t points = 0, normals = 0;
  int views = 1;
};

/// Joins entries of the same cell, in the order of the cells.
void merge_cells(std::vector<ShownCell>& cells) {
  std::ranges::stable_sort(cells, {}, &ShownCell::key);
  std::size_t last = 0;
  for (std::size_t i = 1; i < cells.size(); ++i) {
    const ShownCell& next = cells[i];
    if (next.key != cells[last].key) {
      cells[++last] = next;
      continue;
    }
    ShownCell& cell = cells[last];
    cell.position = cell.position + next.position;
    cell.normal = cell.normal + next.normal;
    cell.colour = cell.colour + next.colour;
    cell.points += next.points;
    cell.normals += next.normals;
    cell.views += next.views;
  }
  cells.resize(std::min(cells.size(), last + 1));
}

std::uint64_t key_of(const CellGrid& grid, V point) {
  const float p[3] = {float(point.x), float(point.y), float(point.z)};
  return grid.of(p);
}

/// The normal of the surface at a pixel, towards the camera; 0 without neighbours.
V normal_at(const DepthView& view, int x, int y) {
  const int r = kNormalReach_px;
  const ImageF& depth = view.depth;
  if (x < r || y < r || x + r >= depth.width_px || y + r >= depth.height_px) return {0, 0, 0};
  for (const auto& [dx, dy] : {std::pair(r, 0), {-r, 0}, {0, r}, {0, -r}})
    if (depth.at(x + dx, y + dy) == 0) return {0, 0, 0};
  const V n =
      cross(view.point(x, y + r) - view.point(x, y - r), view.point(x + r, y) - view.point(x - r, y));  // y is down
  return unit(n);
}

std::vector<ShownCell> cells_of(const DepthView& view, const CellGrid& grid) {
  std::vector<ShownCell> cells;
  for (int y = 0; y < view.depth.height_px; ++y)
    for (int x = 0; x < view.depth.width_px; ++x) {
      if (view.depth.at(x, y) == 0) continue;
      const V point = view.point(x, y), normal = normal_at(view, x, y);
      const V colour{view.colour.at(x, y, 0), view.colour.at(x, y, 1), view.colour.at(x, y, 2)};
      for (const auto& [dx, dy] : {std::pair(0, 0), {1, 0}, {0, 1}, {1, 1}}) {  // far pixels may span several cells
        if (x + dx >= view.depth.width_px || y + dy >= view.depth.height_px || view.depth.at(x + dx, y + dy) == 0)
          continue;
        const V middle = 0.5 * (point + view.point(x + dx, y + dy));
        cells.push_back({key_of(grid, middle), middle, normal, colour, 1, dot(normal, normal) > 0, 0});
      }
    }
  merge_cells(cells);
  cells.shrink_to_fit();
  for (ShownCell& cell : cells) cell.views = 1;
  return cells;
}

double median_pixel(const std::vector<DepthView>& views) {
  constexpr std::size_t kEvery = 7;
  std::vector<double> size;
  for (const DepthView& view : views)
    for (std::size_t p = 0; p < view.depth.data.size(); p += kEvery)
      if (view.depth.data[p] > 0) size.push_back(double(view.depth.data[p]) / view.camera.fx);
  return size.empty() ? 0 : upper_median(std::move(size));
}

/// Whether a view shows a surface more than `margin` behind a point.
bool sees_behind(const DepthView& view, V point, double margin) {
  const std::optional<V> at = view.camera.project(point);
  return at && double(view.depth.at(int(at->x), int(at->y))) > at->z + margin;
}

void find_neighbours(const Exec& exec, SurfaceCells& cells) {
  std::vector<std::vector<std::uint32_t>> of(cells.count());
  for_each_index(exec, std::ssize(of), [&](std::int64_t i) {
    CellGrid::for_neighbours(cells.key[std::size_t(i)], [&](std::uint64_t key) {
      const auto found = std::ranges::lower_bound(cells.key, key);
      const auto k = std::int64_t(found - cells.key.begin());
      if (found != cells.key.end() && *found == key && k != i) of[std::size_t(i)].push_back(std::uint32_t(k));
    });
  });
  cells.first_of.assign(1, 0);
  for (const auto& some : of) {
    cells.neighbour.insert(cells.neighbour.end(), some.begin(), some.end());
    cells.first_of.push_back(cells.neighbour.size());
  }
}

}  // namespace

V DepthView::point(int x, int y) const { return unproject(camera, x + 0.5, y + 0.5, double(depth.at(x, y))); }

DepthView depth_view(const Exec& exec, const GaussianCloud& cloud, const Camera& camera, const SplatOptions& splat) {
  const double scale = std::min(1.0, double(kDepthSide_px) / std::max(camera.width_px, camera.height_px));
  const Camera small = resized(camera, scaled_size_px(camera.width_px, scale), scaled_size_px(camera.height_px, scale));
  const RenderedView view = render(exec, cloud, small, splat, {.depth = true, .label = {}});
  DepthView out{relative_to(small, cloud.origin), ImageF(small.width_px, small.height_px, 1), view.colour};
  for (std::size_t p = 0; p < out.colour.data.size(); ++p)
    out.colour.data[p] = std::max(0.f, std::min(1.f, out.colour.data[p] / std::max(view.alpha.data[p / 3], 0.5f)));
  ImageF inverse(small.width_px, small.height_px, 1);  // the inverse depth of a plane is affine in x and y
  for (std::size_t p = 0; p < inverse.data.size(); ++p)
    if (view.alpha.data[p] > 0.5f && view.depth.data[p] > 0) inverse.data[p] = view.alpha.data[p] / view.depth.data[p];
  for (int y = 1; y + 1 < small.height_px; ++y)
    for (int x = 1; x + 1 < small.width_px; ++x) {
      const float at = inverse.at(x, y);
      const auto is_even = [&](float before, float after) {
        return before > 0 && after > 0 && std::abs(before + after - 2 * at) <= kStep * at;
      };
      if (at > 0 && is_even(inverse.at(x - 1, y), inverse.at(x + 1, y)) &&
          is_even(inverse.at(x, y - 1), inverse.at(x, y + 1)))
        out.depth.at(x, y) = 1 / at;
    }
  return out;
}

std::int64_t SurfaceCells::at(V point) const {
  const std::uint64_t wanted = key_of(CellGrid(centre, side), point);
  const auto found = std::ranges::lower_bound(key, wanted);
  return found != key.end() && *found == wanted ? found - key.begin() : -1;
}

SurfaceCells surface_cells(const Exec& exec, const std::vector<DepthView>& views) {
  SurfaceCells out;
  const double pixel = median_pixel(views);
  if (!(pixel > 0)) return out;
  out.side = SurfaceCells::kCellPixels * pixel;
  out.centre = views[0].camera.centre();
  const CellGrid grid(out.centre, out.side);
  std::vector<std::vector<ShownCell>> of_view(views.size());
  for_each_task(exec, std::ssize(views),
                [&](std::int64_t v) { of_view[std::size_t(v)] = cells_of(views[std::size_t(v)], grid); });
  std::vector<ShownCell> cells;
  for (std::vector<ShownCell>& some : of_view) {
    cells.insert(cells.end(), some.begin(), some.end());
    some = {};
  }
  merge_cells(cells);
  std::vector<std::uint8_t> keep(cells.size());
  for_each_index(exec, std::ssize(cells), [&](std::int64_t i) {
    const ShownCell& cell = cells[std::size_t(i)];
    const V at = (1 / double(cell.points)) * cell.position;
    const auto through =
        std::ranges::count_if(views, [&](const DepthView& view) { return sees_behind(view, at, kBehind * out.side); });
    keep[std::size_t(i)] =
        cell.views >= std::max<std::ptrdiff_t>(std::min<std::ptrdiff_t>(2, std::ssize(views)), through);
  });
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!keep[i]) continue;
    const ShownCell& cell = cells[i];
    out.key.push_back(cell.key);
    out.position.push_back((1 / double(cell.points)) * cell.position);
    out.colour.push_back((1 / double(cell.points)) * cell.colour);
    out.normal.push_back((1 / double(std::max<std::int64_t>(cell.normals, 1))) * cell.normal);
  }
  find_neighbours(exec, out);
  return out;
}

}  // namespace ngs
