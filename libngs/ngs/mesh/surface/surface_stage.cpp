#include "ngs/mesh/surface/surface_stage.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "ngs/backend/for_each.h"
#include "ngs/core/error.h"
#include "ngs/mesh/simplify.h"
#include "ngs/mesh/surface/iso_surface.h"
#include "ngs/mesh/surface/surface_views.h"
#include "ngs/scene/geometry/stance.h"

namespace ngs::mesh {
namespace {

using Vec = Vec3<double>;

constexpr double kRayBands = 3;       // bands: distance from the surface along a ray up to which a pixel is evidence
constexpr double kFreeWeight = 0.05;  // weight of a view in which a place is free; a frontal view of the surface has 1
constexpr double kFreeShare = 0.1;    // share of the views (without those into the object) that make a place outside
constexpr double kLevel = 0.03;       // bands: level of the surface; at 0, the two sides of a thin sheet would cancel
constexpr double kEdge_px = 2;        // width of a contour: alpha falls from 1 to 0

struct Gathered {
  double sum = 0, weight = 0;  // of views that see the surface near it
  double free_sum = 0;         // of distances, band at most
  int free = 0, near = 0;      // views that see it free, and near the surface
  int within = 0;              // views that look into the object

  void add_free(double distance) {
    free_sum += distance;
    ++free;
  }
};

/// Column and row of the pixel that shows a place in camera axes; negative: none does.
std::array<int, 2> pixel_of(const Camera& camera, Vec place) {
  if (!(place.z > 0)) return {-1, -1};
  const double x = camera.fx * place.x / place.z + camera.cx, y = camera.fy * place.y / place.z + camera.cy;
  if (!(x >= 0 && y >= 0 && x < camera.width_px && y < camera.height_px)) return {-1, -1};
  return {int(x), int(y)};
}

/// The observation of one view at a place in camera axes. `from_behind`: behind a plane that the object stands on.
void gather(const SurfaceView& view, bool from_behind, Vec place, double band, Gathered& out) {
  const auto add_free = [&](double distance) {
    if (from_behind)
      ++out.within;
    else
      out.add_free(distance);
  };
  const Camera& camera = view.camera;
  const auto [ix, iy] = pixel_of(camera, place);
  if (ix < 0) return add_free(band);  // all of the object is in the picture
  const std::size_t pixel = view.depth.index(ix, iy);
  const auto depth = double(view.depth.data[pixel]);
  if (depth < 0) {
    ++out.within;
    return;
  }
  if (depth == 0) {
    const double alpha = double(view.alpha.data[pixel]) / 255;
    const double outside = std::min(band, std::max(0.5 - alpha, 0.0) * kEdge_px * place.z / camera.fx);
    return add_free(outside);
  }
  const double ahead = depth - place.z;
  if (ahead < -kRayBands * band) return;
  const auto& n = view.normal[pixel];
  const Vec normal = 1 / 127.0 * Vec{double(n[0]), double(n[1]), double(n[2])};
  const Vec surface = depth * Vec{(ix + 0.5 - camera.cx) / camera.fx, (iy + 0.5 - camera.cy) / camera.fy, 1};
  const double distance = dot(normal, place - surface);
  if (ahead > kRayBands * band || distance >= band) return add_free(band);
  if (distance <= -band) return;
  const double cosine = std::max(-dot(normal, place) / place.z, 0.0);
  const double weight = cosine * cosine * std::min(1.0, 1 + distance / band);
  out.sum += weight * distance;
  out.weight += weight;
  ++out.near;
}

constexpr int kDirections = 64;
constexpr int kViewsPerCell = 2;                // pixels of a view per cell of the grid, along a side
constexpr double kBandCells = 3;                // half-width of the band about the surface
constexpr double kAll = 0.999, kBeyond = 1.05;  // share of the opacity in the ball; factor on the radius of that share
constexpr int kLeastGaussians = 10;
constexpr int kLeastResolution = 16;

orbit::Ball ball_of(Monitor& monitor, const GaussianCloud& cloud) {
  const orbit::SurfacePoints points = orbit::surface_points(cloud);
  if (points.count() < kLeastGaussians)
    throw Error(ErrorCode::kNothingFound,
                "the model: " + std::to_string(points.count()) + " of its " + std::to_string(cloud.size()) +
                    " Gaussians are usable with an opacity above 1/255, expected at least " +
                    std::to_string(kLeastGaussians),
                "give the object.ply of ngs cut or ngs-extract");
  const orbit::Ball bulk = orbit::bulk_of(points);
  if (!orbit::is_alone(points, bulk.centre)) {
    monitor.warn(
        "the model reaches far beyond its middle, like a capture with its surroundings: the mesh shows only the "
        "middle. "
        "Cut an object out first: ngs cut");
    return bulk;
  }
  std::vector<double> distance;
  for (const Vec position : points.position) distance.push_back(length(position - bulk.centre));
  const double all = orbit::weighted_quantile(distance, points.opacity, kAll);
  return {bulk.centre, std::max(bulk.radius, kBeyond * all)};
}

struct Bounds {
  Vec low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  void add(Vec p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
};

Bounds bounds_of(const std::vector<SurfaceView>& views) {
  Bounds bounds;
  for (const SurfaceView& view : views)
    for (std::size_t p = 0; p < view.pixels(); ++p)
      if (view.depth.data[p] > 0) bounds.add(view.point(p));
  if (!(bounds.low.x <= bounds.high.x))
    throw Error(ErrorCode::kNothingFound,
                "the model: no view from around it has a pixel with an alpha of 1/2 or more, expected "
                "an opaque surface",
                "give an object.ply whose Gaussians are opaque");
  return bounds;
}

SampleGrid grid_about(const Bounds& bounds, int resolution) {
  const Vec size = bounds.high - bounds.low;
  SampleGrid grid;
  grid.cell = std::max({size.x, size.y, size.z}) / resolution;
  const double margin = kBandCells + 2;
  grid.low = bounds.low - margin * grid.cell * Vec{1, 1, 1};
  const double sides[3] = {size.x, size.y, size.z};
  for (std::size_t a = 0; a < 3; ++a)
    grid.blocks[a] = int(std::ceil((sides[a] / grid.cell + 2 * margin) / kBlockCells));
  return grid;
}

/// The blocks that contain surface points of the views.
std::vector<std::uint32_t> blocks_of(const std::vector<SurfaceView>& views, const SampleGrid& grid) {
  std::vector<std::uint8_t> touched(grid.block_count());
  const double side = kBlockCells * grid.cell;
  for (const SurfaceView& view : views)
    for (std::size_t p = 0; p < view.pixels(); ++p) {
      if (!(view.depth.data[p] > 0)) continue;
      const Vec at = (1 / side) * (view.point(p) - grid.low);
      touched[std::size_t(at.x) +
              std::size_t(grid.blocks[0]) * (std::size_t(at.y) + std::size_t(grid.blocks[1]) * std::size_t(at.z))] = 1;
    }
  std::vector<std::uint32_t> blocks;
  for (std::size_t b = 0; b < touched.size(); ++b)
    if (touched[b]) blocks.push_back(std::uint32_t(b));
  return blocks;
}

/// Vertices that no view sees get their neighbours' mean colour, from the seen ones inwards; grey if a piece has none.
void paint_unseen(std::vector<std::uint8_t> known, TriangleMesh& mesh) {
  struct Sum {
    Vec3<float> colour{0, 0, 0};
    int count = 0;
  };
  for (bool grows = true; grows;) {
    std::vector<Sum> sums(known.size());
    for (const auto& face : mesh.faces)
      for (const std::uint32_t to : face)
        for (const std::uint32_t from : face)
          if (!known[to] && known[from]) {
            sums[to].colour = sums[to].colour + mesh.colours[from];
            ++sums[to].count;
          }
    grows = false;
    for (std::size_t v = 0; v < sums.size(); ++v) {
      if (sums[v].count == 0) continue;
      mesh.colours[v] = (1 / float(sums[v].count)) * sums[v].colour;
      known[v] = 1;
      grows = true;
    }
  }
}

/// The signed distance to an object's surface, fused from renderings in all directions.
///
/// Each view classifies a place. Free: in front of the surface, or the view shows nothing there. Near: within a band
/// about the surface; the view measures the distance to the pixel's plane, with the squared cosine of the viewing angle
/// as weight, and less weight behind the surface. None: farther behind, or the view looks into the object. The result
/// is the weighted mean distance. A place that too few views see free or near is inside: space that no view reaches is
/// filled.
///
/// The object ends at the planes that it stands on or against. A view from behind such a plane is no evidence of free
/// space. Between a plane and the plane's tolerance, the object continues as it is at the tolerance.
class DistanceField {
 public:
  /// `band`: world; the views must outlive this object. `planes`: that the object stands on or against.
  DistanceField(const std::vector<SurfaceView>& views, double band, std::vector<FillSurface> planes)
      : views_(views), band_(band), planes_(std::move(planes)) {}

  /// The values of a block of `grid` for iso_surface(): distances in units of the band, in [-1, 1].
  void sample(const SampleGrid& grid, std::array<int, 3> low, std::vector<float>& values) const {
    constexpr int kSide = kBlockCells + 1;
    std::vector<Vec> places;
    std::vector<double> beyond(values.size(), -1e300);  // of all planes, behind them
    for (int z = 0; z < kSide; ++z)
      for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
          Vec place = grid.at(low[0] + x, low[1] + y, low[2] + z);
          for (const FillSurface& plane : planes_) {
            const double height = plane.height(place);
            beyond[places.size()] = std::max(beyond[places.size()], -height);
            if (height < plane.tolerance) place = place + (plane.tolerance - height) * plane.normal;
          }
          places.push_back(place);
        }
    std::vector<Gathered> gathered(values.size());
    for (const SurfaceView& view : views_) {
      const Vec eye = view.camera.centre();
      const bool from_behind =
          std::ranges::any_of(planes_, [eye](const FillSurface& plane) { return plane.height(eye) < 0; });
      for (std::size_t k = 0; k < places.size(); ++k)
        gather(view, from_behind, view.camera.to_camera(places[k]), band_, gathered[k]);
    }
    for (std::size_t k = 0; k < values.size(); ++k) {
      const Gathered& at = gathered[k];
      const double enough = std::max(2.0, kFreeShare * double(int(views_.size()) - at.within));
      const double weight = at.weight + kFreeWeight * at.free;
      const double distance = at.near == 0 ? 1 : (at.sum + kFreeWeight * at.free_sum) / (weight * band_) - kLevel;
      values[k] = float(std::max(beyond[k] / band_, std::min(distance, (at.free + at.near - enough) / enough)));
    }
  }

  /// The mean colour [0, 1] sRGB of the views that see a point of the surface with this normal, weighted by the square
  /// of the cosine; nothing if none does.
  std::optional<Vec3<float>> colour(Vec point, Vec normal) const {
    Vec sum{0, 0, 0};
    double total = 0;
    for (const SurfaceView& view : views_) {
      const Camera& camera = view.camera;
      const Vec place = camera.to_camera(point);
      const double cosine = -dot(camera.rotation * normal, unit(place));
      const auto [x, y] = pixel_of(camera, place);
      if (!(cosine > 0) || x < 0) continue;
      const std::size_t pixel = view.depth.index(x, y);
      const auto depth = double(view.depth.data[pixel]);
      if (!(depth > 0) || std::abs(depth - place.z) > band_) continue;
      const double weight = cosine * cosine;
      const std::uint8_t* rgb = &view.colour.data[3 * pixel];
      sum = sum + weight * Vec{double(rgb[0]), double(rgb[1]), double(rgb[2])};
      total += weight;
    }
    if (!(total > 0)) return std::nullopt;
    return Vec3<float>{float(sum.x / (255 * total)), float(sum.y / (255 * total)), float(sum.z / (255 * total))};
  }

 private:
  const std::vector<SurfaceView>& views_;
  double band_;
  std::vector<FillSurface> planes_;
};

void paint(const Exec& exec, const DistanceField& field, TriangleMesh& mesh) {
  const std::vector<Vec3<float>> normals = vertex_normals(mesh);
  mesh.colours.assign(mesh.vertices.size(), {0.5f, 0.5f, 0.5f});
  std::vector<std::uint8_t> known(mesh.vertices.size(), 0);
  for_each_index(exec, std::ssize(mesh.vertices), [&](std::int64_t v) {
    const Vec3<float> n = normals[std::size_t(v)];
    const auto seen = field.colour(mesh.at(std::uint32_t(v)), {double(n.x), double(n.y), double(n.z)});
    known[std::size_t(v)] = seen.has_value();
    if (seen) mesh.colours[std::size_t(v)] = *seen;
  });
  paint_unseen(std::move(known), mesh);
}

DistanceField field_of(const std::vector<SurfaceView>& views, double cell, const std::vector<FillSurface>& planes) {
  return {views, kBandCells * cell, planes};
}

/// The surface in a grid, without colours; empty if it encloses no volume. It has more faces than `options.faces` only
/// if its topology (tunnels and pieces) needs them.
ObjectMesh surface_in(const Exec& exec, Monitor& monitor, const std::vector<SurfaceView>& views,
                      const std::vector<FillSurface>& planes, const MeshOptions& options) {
  const SampleGrid grid = grid_about(bounds_of(views), options.resolution);
  const DistanceField field = field_of(views, grid.cell, planes);
  ObjectMesh out;
  out.cell = grid.cell;
  {
    const auto timed = monitor.scope("surface");
    out.mesh = iso_surface(exec, grid, blocks_of(views, grid), [&](std::array<int, 3> low, std::vector<float>& values) {
      field.sample(grid, low, values);
    });
  }
  out.pieces = keep_pieces(options.least_piece, out.mesh);
  out.extracted_faces = out.mesh.faces.size();
  if (options.faces > 0) {
    const auto timed = monitor.scope("simplify");
    simplify(std::size_t(options.faces), out.mesh);
  }
  return out;
}

/// The surface at `options.resolution` or, while it needs more than `options.faces`, at half of it and so on.
ObjectMesh surface_with_faces(const Exec& exec, Monitor& monitor, const std::vector<SurfaceView>& views,
                              const std::vector<FillSurface>& planes, const MeshOptions& options) {
  ObjectMesh out = surface_in(exec, monitor, views, planes, options);
  const std::size_t finest = out.mesh.faces.size();
  const std::size_t most = options.faces > 0 ? std::size_t(options.faces) : finest;
  if (finest <= most) return out;
  int used = options.resolution;
  for (int r = used / 2; out.mesh.faces.size() > most && r >= kLeastResolution; r /= 2) {
    MeshOptions at = options;
    at.resolution = r;
    ObjectMesh coarser = surface_in(exec, monitor, views, planes, at);
    if (coarser.mesh.faces.empty() || coarser.mesh.faces.size() >= out.mesh.faces.size()) break;
    out = std::move(coarser);
    used = r;
  }
  monitor.warn("--faces " + std::to_string(most) + ": the tunnels and pieces of the surface need " +
               std::to_string(finest) + " faces at --resolution " + std::to_string(options.resolution) +
               "; the mesh has " + std::to_string(out.mesh.faces.size()) + ", at --resolution " + std::to_string(used));
  return out;
}

}  // namespace

std::vector<FillSurface> planes_behind(const Exec& exec, const GaussianCloud& object, const GaussianCloud& rest,
                                       std::uint64_t seed) {
  GaussianCloud all = object;
  std::vector<std::uint8_t> of_object(std::size_t(object.size()), 1);
  of_object.resize(of_object.size() + std::size_t(rest.size()), 0);
  for (std::size_t i = 0; i < rest.position.size(); ++i)
    all.position.push_back(float(double(rest.position[i]) + (rest.origin[i % 3] - object.origin[i % 3])));
  const auto append = [](const auto& from, auto& to) { to.insert(to.end(), from.begin(), from.end()); };
  append(rest.rotation, all.rotation);
  append(rest.log_scale, all.log_scale);
  append(rest.logit_opacity, all.logit_opacity);
  append(rest.usable, all.usable);
  return supporting_planes(exec, all, of_object, seed);
}

ObjectMesh mesh_of(const Exec& exec, Monitor& monitor, const GaussianCloud& cloud, const MeshOptions& options,
                   const std::vector<FillSurface>& planes) {
  const std::vector<SurfaceView> views = [&] {
    const auto timed = monitor.scope("render");
    return render_surface_views(
        exec, cloud,
        {orbit::even_directions(kDirections), ball_of(monitor, cloud), kViewsPerCell * options.resolution});
  }();
  ObjectMesh out = surface_with_faces(exec, monitor, views, planes, options);
  if (out.mesh.faces.empty())
    throw Error(ErrorCode::kNothingFound, "the model: its surface encloses no volume, expected a solid object",
                "raise --resolution for thin parts");
  const auto timed = monitor.scope("colours");
  paint(exec, field_of(views, out.cell, planes), out.mesh);
  return out;
}

}  // namespace ngs::mesh
