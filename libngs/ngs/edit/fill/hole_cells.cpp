#include "ngs/edit/fill/hole_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ngs/backend/for_each.h"
#include "ngs/math/quat.h"

namespace ngs {
namespace {

using orbit::Vec;

constexpr double kMaxAcross = 320;              // cells along a side of the grid
constexpr double kCellOfSpacing = 0.7;          // side of a cell, in spacings of the surface's Gaussians
constexpr double kMargin = 0.55;                // band that supplies texture, as a share of the footprint's longer side
constexpr double kCovered = 0.3, kEmpty = 0.5;  // transmittance: maximum of a covered cell, minimum of an open one
constexpr double kMaxOpen = 0.25;               // maximum open share of the outline of a hole
constexpr double kCut = 3;                      // standard deviations at which a drawn Gaussian is cut off
constexpr int kHoleDirections = 160;            // over the sphere
constexpr double kMinElevation = 0.2;           // sine: no camera looks along a surface
constexpr double kMaxSeen = 0.65;               // maximum share of the directions that see a cell of the hole
constexpr double kContact = 0.3;                // diagonals: height of the object's part that stands on a surface
constexpr double kDilation = 0.03;              // diagonals: margin of the object's projection
constexpr double kStanding = 0.5;
constexpr double kInside = 0.3;                     // minimum weight of a Gaussian in a cell that it occupies
constexpr double kWhole = 0.75, kContinues = 0.75;  // minima of a continued surface: covered share; share x density
constexpr double kCrowded = 2;                      // relative to the rim: denser Gaussians are remains of the object

/// A Gaussian on the surface in cells: its centre and the inverse of its covariance.
struct Disc {
  double x, y, xx, xy, yy, reach_x, reach_y;
};

Disc disc_of(const GaussianCloud& cloud, const FillSurface& surface, const HoleCells& cells, std::size_t row) {
  const Vec2<double> at =
      surface.coordinates(Vec{cloud.position[3 * row], cloud.position[3 * row + 1], cloud.position[3 * row + 2]});
  const Mat3<double> axes = axes_of_quaternion(&cloud.rotation[4 * row]);
  double xx = 0.09, xy = 0, yy = 0.09;  // 0.3 cells: a Gaussian thinner than a cell has a width all the same
  for (int k = 0; k < 3; ++k) {
    const double size = std::exp(double(cloud.log_scale[3 * row + std::size_t(k)])) / cells.side;
    const Vec axis{axes(0, k), axes(1, k), axes(2, k)};
    const double x = size * dot(surface.u, axis), y = size * dot(surface.v, axis);
    xx += x * x;
    xy += x * y;
    yy += y * y;
  }
  const double det = xx * yy - xy * xy;
  return {(at.x - cells.low.x) / cells.side - 0.5,
          (at.y - cells.low.y) / cells.side - 0.5,
          yy / det,
          -xy / det,
          xx / det,
          kCut * std::sqrt(xx),
          kCut * std::sqrt(yy)};
}

/// Calls visit(cell, weight) for the cells that a Gaussian of the surface reaches; the weight is 1 at its centre.
template <class Visit>
void for_cells(const HoleCells& cells, const Disc& f, const Visit& visit) {
  const auto first = [](double x) { return std::int64_t(std::max(0.0, std::ceil(x))); };
  const auto last = [](double x, std::int64_t n) { return std::int64_t(std::min(double(n - 1), std::floor(x))); };
  for (std::int64_t y = first(f.y - f.reach_y); y <= last(f.y + f.reach_y, cells.rows); ++y)
    for (std::int64_t x = first(f.x - f.reach_x); x <= last(f.x + f.reach_x, cells.columns); ++x) {
      const double dx = double(x) - f.x, dy = double(y) - f.y;
      const double d2 = f.xx * dx * dx + 2 * f.xy * dx * dy + f.yy * dy * dy;
      if (d2 <= kCut * kCut) visit(y * cells.columns + x, std::exp(-0.5 * d2));
    }
}

/// The grid around the projection of the object, with a margin that supplies texture.
HoleCells grid_around(const Rim& rim, const FillSurface& surface) {
  Vec2<double> low{1e300, 1e300}, high{-1e300, -1e300};
  for (const Vec& p : rim.object.position) {
    const Vec2<double> at = surface.coordinates(p);
    low = {std::min(low.x, at.x), std::min(low.y, at.y)};
    high = {std::max(high.x, at.x), std::max(high.y, at.y)};
  }
  const double margin = std::max(kMargin * std::max(high.x - low.x, high.y - low.y), 4 * surface.spacing);
  HoleCells cells;
  cells.low = {low.x - margin, low.y - margin};
  const double width = high.x - low.x + 2 * margin, height = high.y - low.y + 2 * margin;
  cells.side = std::max(kCellOfSpacing * surface.spacing, std::max(width, height) / kMaxAcross);
  cells.columns = std::int64_t(std::ceil(width / cells.side));
  cells.rows = std::int64_t(std::ceil(height / cells.side));
  cells.state.assign(std::size_t(cells.columns * cells.rows), HoleCell::kOpen);
  cells.colour.assign(3 * cells.state.size(), 0.f);
  return cells;
}

/// Composites the Gaussians of the surface along its normal, the highest first: colour and state of every cell.
void draw_surface(const HoleScene& scene, std::size_t index, HoleCells& cells) {
  const FillSurface& surface = scene.surfaces[index];
  const orbit::SurfacePoints& points = scene.rim.background;
  struct Drawn {
    double height;
    std::uint32_t point;
  };
  std::vector<Drawn> drawn;
  for (std::size_t i = 0; i < points.count(); ++i) {
    if (scene.debris[i]) continue;
    const double height = surface.height(points.position[i]);
    if (std::abs(height) <= surface.tolerance + std::min(points.size[i], surface.spacing))
      drawn.push_back({height, std::uint32_t(i)});
  }
  std::ranges::sort(drawn, [](const Drawn& a, const Drawn& b) {
    return a.height != b.height ? a.height > b.height : a.point < b.point;
  });
  std::vector<double> left(cells.state.size(), 1.0), sum(3 * cells.state.size());
  for (const Drawn& d : drawn) {
    const std::size_t row = points.row[d.point];
    const Disc f = disc_of(scene.cloud, surface, cells, row);
    for_cells(cells, f, [&](std::int64_t cell, double weight) {
      const double alpha = std::min(0.99, points.opacity[d.point] * weight), part = left[std::size_t(cell)] * alpha;
      for (std::size_t c = 0; c < 3; ++c)
        sum[3 * std::size_t(cell) + c] += part * double(scene.cloud.sh_dc[3 * row + c]);
      left[std::size_t(cell)] -= part;
    });
  }
  for (std::size_t cell = 0; cell < left.size(); ++cell) {
    if (left[cell] >= kEmpty) continue;
    cells.state[cell] = left[cell] <= kCovered ? HoleCell::kCovered : HoleCell::kWeak;
    for (std::size_t c = 0; c < 3; ++c) cells.colour[3 * cell + c] = float(sum[3 * cell + c] / (1 - left[cell]));
  }
}

/// Whether two surfaces meet in an edge, as floor and wall do. Nearly parallel ones do not: two steps, or a floor and a
/// plane through remains of an object on it, which is tilted by 8 to 20 degrees (decision 080).
bool meets(const FillSurface& a, const FillSurface& b) {
  constexpr double kParallel = 0.87;  // cosine of 30 degrees
  return std::abs(dot(a.normal, b.normal)) < kParallel;
}

void clip(const HoleScene& scene, std::size_t index, HoleCells& cells) {
  for (std::size_t cell = 0; cell < cells.state.size(); ++cell) {
    const Vec2<double> at = cells.centre(std::int64_t(cell));
    const Vec p = scene.surfaces[index].point(at.x, at.y, 0);
    for (std::size_t other = 0; other < scene.surfaces.size(); ++other)
      if (other != index && meets(scene.surfaces[index], scene.surfaces[other]) && scene.surfaces[other].height(p) < 0)
        cells.state[cell] = HoleCell::kClipped;
  }
}

/// Excludes cells below other opaque things from the texture, because such things shade and tint them.
void exclude_occupied(const HoleScene& scene, const FillSurface& surface, HoleCells& cells) {
  const orbit::SurfacePoints& points = scene.rim.background;
  for (std::size_t i = 0; i < points.count(); ++i) {
    const double height = surface.height(points.position[i]);
    if (scene.debris[i] || points.opacity[i] < kStanding || height < 2 * surface.tolerance ||
        height > kContact * scene.rim.diagonal)
      continue;
    for_cells(cells, disc_of(scene.cloud, surface, cells, points.row[i]), [&](std::int64_t cell, double weight) {
      if (weight > kInside && cells.state[std::size_t(cell)] == HoleCell::kCovered)
        cells.state[std::size_t(cell)] = HoleCell::kWeak;
    });
  }
}

/// The cells below the part of the object that is at most `band` above the surface.
std::vector<std::uint8_t> below_object(const HoleScene& scene, const FillSurface& surface, const HoleCells& cells,
                                       double band) {
  std::vector<std::uint8_t> below(cells.state.size());
  const orbit::SurfacePoints& object = scene.rim.object;
  for (std::size_t i = 0; i < object.count(); ++i)
    if (surface.height(object.position[i]) <= band)
      for_cells(cells, disc_of(scene.cloud, surface, cells, object.row[i]), [&](std::int64_t cell, double weight) {
        if (weight > kInside) below[std::size_t(cell)] = 1;
      });
  return below;
}

/// The share of the directions in front of all surfaces from which the object does not hide the point.
double openness(const HoleScene& scene, const FillSurface& surface, Vec p, const std::vector<Vec>& directions) {
  double open = 0, all = 0;
  for (const Vec& direction : directions) {
    const bool behind =
        std::ranges::any_of(scene.surfaces, [&](const FillSurface& other) { return dot(direction, other.normal) < 0; });
    if (behind || dot(direction, surface.normal) < kMinElevation) continue;
    ++all;
    open += !scene.occluder.hides(p, direction);
  }
  return all > 0 ? open / all : 1;
}

/// Sets kHole in open cells below the object, and in cells that it stands on and hides from most directions.
void mark_hole(const Exec& exec, const HoleScene& scene, std::size_t index, const std::vector<std::uint8_t>& footprint,
               HoleCells& cells) {
  const FillSurface& surface = scene.surfaces[index];
  const int margin = std::clamp(int(kDilation * scene.rim.diagonal / cells.side), 1, 6);
  const std::vector<std::uint8_t> below =
      dilated(cells, below_object(scene, surface, cells, std::numeric_limits<double>::infinity()), margin);
  const std::vector<std::uint8_t> contact = dilated(cells, footprint, margin);
  const std::vector<Vec> directions = orbit::even_directions(kHoleDirections);
  for_each_index(exec, std::int64_t(cells.state.size()), [&](std::int64_t i) {
    HoleCell& state = cells.state[std::size_t(i)];
    if (!below[std::size_t(i)] || state == HoleCell::kClipped) return;
    const Vec2<double> at = cells.centre(i);
    if (state == HoleCell::kOpen ||
        (contact[std::size_t(i)] && openness(scene, surface, surface.point(at.x, at.y, 0), directions) <= kMaxSeen))
      state = HoleCell::kHole;
  });
}

/// Visits the four neighbours of a cell; -1 for those outside of the grid.
template <class Visit>
void for_sides(const HoleCells& cells, std::int64_t cell, const Visit& visit) {
  const std::int64_t x = cell % cells.columns, y = cell / cells.columns;
  visit(x > 0 ? cell - 1 : -1);
  visit(x + 1 < cells.columns ? cell + 1 : -1);
  visit(y > 0 ? cell - cells.columns : -1);
  visit(y + 1 < cells.rows ? cell + cells.columns : -1);
}

/// Solid Gaussians of the surface per cell.
std::vector<int> solid_counts(const HoleScene& scene, const FillSurface& surface, const HoleCells& cells) {
  std::vector<int> counts(cells.state.size());
  for (const std::uint32_t k : scene.rim.solid) {
    const Vec p = scene.rim.background.position[k];
    const std::int64_t cell = cells.cell_of(surface.coordinates(p));
    if (cell >= 0 && std::abs(surface.height(p)) <= surface.tolerance) ++counts[std::size_t(cell)];
  }
  return counts;
}

/// Drops parts of the hole whose outline is open by more than kMaxOpen, and parts that the surface covers as densely as
/// the rim. `before`: the states without a hole.
void keep_holes(const HoleScene& scene, const FillSurface& surface, const std::vector<HoleCell>& before,
                HoleCells& cells) {
  const std::vector<int> solid = solid_counts(scene, surface, cells);
  const double usual = cells.side * cells.side / (surface.spacing * surface.spacing);
  std::vector<std::uint8_t> visited(cells.state.size());
  for (std::size_t start = 0; start < cells.state.size(); ++start) {
    if (visited[start] || cells.state[start] != HoleCell::kHole) continue;
    std::vector<std::int64_t> part{std::int64_t(start)};
    visited[start] = 1;
    double open = 0, outline = 0;
    for (std::size_t k = 0; k < part.size(); ++k)
      for_sides(cells, part[k], [&](std::int64_t next) {
        const HoleCell state = next < 0 ? HoleCell::kOpen : cells.state[std::size_t(next)];
        if (state != HoleCell::kHole) {
          ++outline;
          open += state == HoleCell::kOpen;
        } else if (!visited[std::size_t(next)]) {
          visited[std::size_t(next)] = 1;
          part.push_back(next);
        }
      });
    double covered = 0, count = 0;
    for (const std::int64_t cell : part) {
      covered += before[std::size_t(cell)] == HoleCell::kCovered;
      count += solid[std::size_t(cell)];
    }
    const auto size = double(part.size());
    const bool is_enclosed = open <= kMaxOpen * outline;
    const double density = count / (usual * size);
    const bool continues = covered >= kWhole * size && covered * density >= kContinues * size && density < kCrowded;
    if (is_enclosed && !continues) {
      cells.hole += std::int64_t(part.size());
      continue;
    }
    (is_enclosed ? cells.continued : cells.one_sided) += std::int64_t(part.size());
    for (const std::int64_t cell : part) cells.state[std::size_t(cell)] = before[std::size_t(cell)];
  }
}

}  // namespace

std::int64_t HoleCells::cell_of(Vec2<double> at) const {
  const double x = std::floor((at.x - low.x) / side), y = std::floor((at.y - low.y) / side);
  if (!(x >= 0 && y >= 0 && x < double(columns) && y < double(rows))) return -1;
  return std::int64_t(y) * columns + std::int64_t(x);
}

double share_in_hole(const GaussianCloud& cloud, const FillSurface& surface, const HoleCells& cells, std::size_t row) {
  double in = 0, all = 0;
  for_cells(cells, disc_of(cloud, surface, cells, row), [&](std::int64_t cell, double weight) {
    all += weight;
    if (cells.state[std::size_t(cell)] == HoleCell::kHole) in += weight;
  });
  return all > 0 ? in / all : 0;
}

std::vector<std::uint8_t> dilated(const HoleCells& cells, std::vector<std::uint8_t> marked, int margin) {
  for (const bool along_rows : {true, false}) {
    const std::int64_t step = along_rows ? 1 : cells.columns, length = along_rows ? cells.columns : cells.rows;
    const std::vector<std::uint8_t> before = marked;
    for (std::size_t cell = 0; cell < marked.size(); ++cell) {
      const std::int64_t k = along_rows ? std::int64_t(cell) % cells.columns : std::int64_t(cell) / cells.columns;
      const std::int64_t first = std::max<std::int64_t>(-margin, -k),
                         last = std::min<std::int64_t>(margin, length - 1 - k);
      for (std::int64_t d = first; d <= last; ++d) marked[cell] |= before[std::size_t(std::int64_t(cell) + d * step)];
    }
  }
  return marked;
}

HoleCells find_hole_cells(const Exec& exec, const HoleScene& scene, std::size_t index) {
  HoleCells cells = grid_around(scene.rim, scene.surfaces[index]);
  draw_surface(scene, index, cells);
  clip(scene, index, cells);
  exclude_occupied(scene, scene.surfaces[index], cells);
  const std::vector<HoleCell> before = cells.state;
  const std::vector<std::uint8_t> footprint =
      below_object(scene, scene.surfaces[index], cells, kContact * scene.rim.diagonal);
  mark_hole(exec, scene, index, footprint, cells);
  keep_holes(scene, scene.surfaces[index], before, cells);
  for (std::size_t i = 0; cells.hole + cells.continued > 0 && i < footprint.size(); ++i) {
    if (!footprint[i] || cells.state[i] == HoleCell::kClipped) continue;
    ++cells.footprint.cells;
    cells.footprint.filled += cells.state[i] == HoleCell::kHole;
    cells.footprint.covered += cells.state[i] == HoleCell::kCovered;
  }
  return cells;
}

}  // namespace ngs
