#include "support/mesh_truth.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ngs/core/check.h"
#include "ngs/math/quat.h"
#include "ngs/math/sh.h"
#include "ngs/math/vectors.h"
#include "ngs/mesh/surface/iso_surface.h"
#include "ngs/ops/neighbours/knn.h"
#include "support/random.h"

namespace ngs::test {
namespace {

using Vec = Vec3<double>;

constexpr int kSamples = 40000, kColumns = 160;

struct Box {
  Vec low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
};
Box box_of(const synth::Object& object) {
  Box box;
  for (const synth::Solid& s : object.solids) {
    const Vec r{s.bound_radius, s.bound_radius, s.bound_radius}, low = s.centre - r, high = s.centre + r;
    box.low = {std::min(box.low.x, low.x), std::min(box.low.y, low.y), std::min(box.low.z, low.z)};
    box.high = {std::max(box.high.x, high.x), std::max(box.high.y, high.y), std::max(box.high.z, high.z)};
  }
  return box;
}

/// Whether the segment from just above a surface point to the camera meets no object.
bool sees(const Camera& camera, const synth::AnalyticScene& scene, const MeshSample& point) {
  const Vec eye = camera.centre(), way = eye - point.at;
  if (!(dot(unit(way), point.normal) > 0.1) || !camera.project(point.at)) return false;
  const Vec direction = unit(way);
  for (double t = 0.01; t < length(way);) {
    double free = 1e300;
    for (const synth::Object& object : scene.objects)
      free = std::min(free, distance_to(object, point.at + t * direction));
    if (free < 1e-4) return false;
    t += std::max(free, 1e-3);
  }
  return true;
}

std::vector<MeshSample> seen_of(const std::vector<MeshSample>& points, const synth::AnalyticScene& scene,
                                const std::vector<Camera>& cameras) {
  if (cameras.empty()) return points;
  std::vector<MeshSample> seen;
  for (const MeshSample& point : points)
    if (std::ranges::any_of(cameras, [&](const Camera& camera) { return sees(camera, scene, point); }))
      seen.push_back(point);
  return seen;
}

std::vector<float> positions_of(const std::vector<MeshSample>& points) {
  std::vector<float> out;
  for (const MeshSample& p : points)
    for (const double value : {p.at.x, p.at.y, p.at.z}) out.push_back(float(value));
  return out;
}

/// Heights at which the vertical line through (x, y) crosses the mesh, ascending: inside is between odd and even ones.
std::vector<std::vector<double>> crossings_of(const TriangleMesh& mesh, Vec low, double cell) {
  std::vector<std::vector<double>> heights(std::size_t(kColumns) * kColumns);
  for (const auto& face : mesh.faces) {
    const Vec a = mesh.at(face[0]), b = mesh.at(face[1]), c = mesh.at(face[2]);
    const auto first = [&](double p, double q, double r, double from) {
      return std::clamp(int((std::min({p, q, r}) - from) / cell) - 1, 0, kColumns);
    };
    const auto last = [&](double p, double q, double r, double from) {
      return std::clamp(int((std::max({p, q, r}) - from) / cell) + 2, 0, kColumns);
    };
    const double twice = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
    if (twice == 0) continue;
    for (int j = first(a.y, b.y, c.y, low.y); j < last(a.y, b.y, c.y, low.y); ++j)
      for (int i = first(a.x, b.x, c.x, low.x); i < last(a.x, b.x, c.x, low.x); ++i) {
        const double x = low.x + (i + 0.4871) * cell, y = low.y + (j + 0.5133) * cell;
        const double u = ((x - a.x) * (c.y - a.y) - (c.x - a.x) * (y - a.y)) / twice;
        const double v = ((b.x - a.x) * (y - a.y) - (x - a.x) * (b.y - a.y)) / twice;
        if (u < 0 || v < 0 || u + v > 1) continue;
        heights[std::size_t(j) * kColumns + std::size_t(i)].push_back(a.z + u * (b.z - a.z) + v * (c.z - a.z));
      }
  }
  for (auto& column : heights) std::ranges::sort(column);
  return heights;
}

double iou_of(const TriangleMesh& mesh, const synth::Object& object) {
  Box box = box_of(object);
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec p = mesh.at(v);
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
  }
  const Vec size = box.high - box.low;
  const double cell = std::max(size.x, size.y) / kColumns;
  const auto columns = crossings_of(mesh, box.low, cell);
  double both = 0, either = 0;
  for (std::size_t k = 0; k < columns.size(); ++k)
    for (double z = box.low.z + 0.5 * cell; z < box.high.z; z += cell) {
      const std::size_t column = k % kColumns;
      const std::size_t row = k / kColumns;
      const Vec p{box.low.x + (double(column) + 0.4871) * cell, box.low.y + (double(row) + 0.5133) * cell, z};
      const bool in_truth = distance_to(object, p) < 0;
      const bool in_mesh = (std::ranges::lower_bound(columns[k], z) - columns[k].begin()) % 2 == 1;
      both += in_truth && in_mesh;
      either += in_truth || in_mesh;
    }
  return both / std::max(either, 1.0);
}

}  // namespace

synth::Object recipe_object(const std::string& recipe, const std::string& name) {
  const synth::AnalyticScene scene = synth::build_scene(synth::named_recipe(recipe));
  const auto found = std::ranges::find(scene.objects, name, &synth::Object::name);
  NGS_CHECK(found != scene.objects.end(), "no such object");
  return *found;
}

double distance_to(const synth::Object& object, Vec p) {
  double least = 1e300;
  for (const synth::Solid& solid : object.solids) least = std::min(least, synth::signed_distance(solid, p));
  return least;
}

Vec normal_at(const synth::Object& object, Vec p) {
  const auto nearest = std::ranges::min_element(
      object.solids, {}, [&](const synth::Solid& solid) { return synth::signed_distance(solid, p); });
  return synth::surface_normal(*nearest, p);
}

TriangleMesh true_mesh(const synth::Object& object, int cells) {
  const Box box = box_of(object);
  const Vec size = box.high - box.low;
  mesh::SampleGrid grid;
  grid.cell = std::max({size.x, size.y, size.z}) / cells;
  grid.low = box.low - 2 * grid.cell * Vec{1, 1, 1};
  const double sides[3] = {size.x, size.y, size.z};
  for (std::size_t a = 0; a < 3; ++a) grid.blocks[a] = int(sides[a] / grid.cell + 4) / mesh::kBlockCells + 1;
  std::vector<std::uint32_t> seeds(grid.block_count());
  for (std::size_t b = 0; b < seeds.size(); ++b) seeds[b] = std::uint32_t(b);
  return mesh::iso_surface({.threads = 2}, grid, seeds, [&](std::array<int, 3> low, std::vector<float>& values) {
    constexpr int kSide = mesh::kBlockCells + 1;
    for (std::size_t k = 0; k < values.size(); ++k)
      values[k] = float(distance_to(
          object, grid.at(low[0] + int(k) % kSide, low[1] + int(k) / kSide % kSide, low[2] + int(k) / kSide / kSide)));
  });
}

std::vector<MeshSample> samples_of(const TriangleMesh& mesh, int count) {
  std::vector<double> sum{0};
  for (const auto& [a, b, c] : mesh.faces)
    sum.push_back(sum.back() + 0.5 * length(cross(mesh.at(b) - mesh.at(a), mesh.at(c) - mesh.at(a))));
  Random random(5);
  std::vector<MeshSample> points;
  for (int k = 0; k < count; ++k) {
    const double target = (k + 0.5) / count * sum.back();
    const auto f = std::size_t(std::ranges::upper_bound(sum, target) - sum.begin()) - 1;
    const auto& face = mesh.faces[std::min(f, mesh.faces.size() - 1)];
    const Vec a = mesh.at(face[0]), b = mesh.at(face[1]), c = mesh.at(face[2]);
    const double root = std::sqrt(random.uniform(0, 1)), v = random.uniform(0, 1);
    points.push_back({(1 - root) * a + (root * (1 - v)) * b + (root * v) * c, unit(cross(b - a, c - a))});
  }
  return points;
}

GaussianCloud splat_of(const synth::Object& object, int count) {
  const std::vector<MeshSample> points = samples_of(true_mesh(object, 128), count);
  double area = 0;
  for (const TriangleMesh mesh = true_mesh(object, 64); const auto& [a, b, c] : mesh.faces)
    area += 0.5 * length(cross(mesh.at(b) - mesh.at(a), mesh.at(c) - mesh.at(a)));
  const double deviation = 0.8 * std::sqrt(area / count);
  GaussianCloud cloud;
  cloud.resize(count, 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec normal = normal_at(object, points[i].at), x = orbit::perpendicular(normal), y = cross(normal, x);
    const Vec at = points[i].at - distance_to(object, points[i].at) * normal;
    const Vec rgb = synth::albedo(object.texture, at);
    const auto q = stored_quaternion({{x.x, y.x, normal.x, x.y, y.y, normal.y, x.z, y.z, normal.z}});
    std::ranges::copy(q, &cloud.rotation[4 * i]);
    const double p[3] = {at.x, at.y, at.z}, c[3] = {rgb.x, rgb.y, rgb.z};
    for (std::size_t k = 0; k < 3; ++k) {
      cloud.position[3 * i + k] = float(p[k]);
      cloud.log_scale[3 * i + k] = float(std::log(k < 2 ? deviation : 0.05 * deviation));
      cloud.sh_dc[3 * i + k] = float(dc_of_colour(c[k]));
    }
    cloud.logit_opacity[i] = 3;
  }
  return cloud;
}

MeshScore score_of(const TriangleMesh& mesh, const synth::AnalyticScene& scene, int object,
                   const std::vector<Camera>& cameras, double near) {
  const synth::Object& truth = scene.objects[std::size_t(object)];
  MeshScore score;
  const std::vector<MeshSample> of_mesh = samples_of(mesh, kSamples);
  const std::vector<MeshSample> of_truth = seen_of(samples_of(true_mesh(truth, 160), kSamples), scene, cameras);
  const std::vector<float> mesh_at = positions_of(of_mesh), truth_at = positions_of(of_truth);
  const auto rows = [](const std::vector<float>& p) {
    return Rows<const float, 3>{p.data(), std::int64_t(p.size() / 3)};
  };
  const KnnGraph to_mesh = nearest_points({.threads = 2}, rows(mesh_at), rows(truth_at), 1);
  for (std::size_t i = 0; i < of_truth.size(); ++i) {
    const MeshSample& nearest = of_mesh[to_mesh.index[i]];
    const Vec offset = of_truth[i].at - nearest.at;
    // The nearest sample is not the nearest point: along the face it lies about half a sample spacing away.
    const double along = dot(offset, nearest.normal), distance = length(offset);
    const double spacing = std::sqrt(double(to_mesh.dist2[i]));
    const double d = std::abs(along) < distance && spacing < near ? std::abs(along) : distance;
    score.from_truth += d;
    score.seen_within += d <= near;
  }
  const KnnGraph to_seen = nearest_points({.threads = 2}, rows(truth_at), rows(mesh_at), 1);
  double count = 0;
  for (std::size_t i = 0; i < of_mesh.size(); ++i) {
    if (std::sqrt(double(to_seen.dist2[i])) > 4 * near) continue;  // an unseen part
    ++count;
    score.to_truth += std::abs(distance_to(truth, of_mesh[i].at));
    const double cosine = std::clamp(dot(of_mesh[i].normal, normal_at(truth, of_mesh[i].at)), -1.0, 1.0);
    score.normal_deg += std::acos(cosine) * 180 / std::numbers::pi;
  }
  const double seen = std::max(double(of_truth.size()), 1.0);
  score.from_truth /= seen;
  score.seen_within /= seen;
  score.to_truth /= std::max(count, 1.0);
  score.normal_deg /= std::max(count, 1.0);
  score.iou = iou_of(mesh, truth);
  return score;
}

}  // namespace ngs::test
