#include "ngs/mesh/surface/distance_field.h"

#include <algorithm>
#include <cmath>

namespace ngs::mesh {
namespace {

using Vec = Vec3<double>;

constexpr double kRayBands = 3;       // bands along the ray within which a pixel's plane says where its surface is
constexpr double kFreeWeight = 0.05;  // of a view that sees a place free; 1: of one that looks straight at the surface
constexpr double kFreeShare = 0.1;    // of the views that do not look into the object: as many make a place outside
constexpr double kLevel = 0.03;       // bands: keeps thin sheets, whose two sides cancel out at 0
constexpr double kEdge_px = 2;        // width of a contour: alpha falls from 1 to 0

/// What the views say about one place.
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

}  // namespace

void DistanceField::sample(const SampleGrid& grid, std::array<int, 3> low, std::vector<float>& values) const {
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

std::optional<Vec3<float>> DistanceField::colour(Vec point, Vec normal) const {
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

}  // namespace ngs::mesh
