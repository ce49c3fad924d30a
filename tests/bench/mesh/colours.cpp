// How much colour a mesh loses: its renderings against those of the splat, from 64 directions.
//
//   ngs_mesh_colours SPLAT [FACES]
//
// stdout, tab separated: FACES, then PSNR in dB over the pixels that both cover with the colours of the vertices, and
// with colours at every pixel, which is what a texture without limits would give.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "ngs/core/error.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/mesh/surface/distance_field.h"
#include "ngs/mesh/surface/surface_stage.h"
#include "ngs/scene/geometry/frame.h"

namespace ngs::bench {
namespace {

using Vec = Vec3<double>;

struct Hit {
  double depth = 1e300;
  std::uint32_t face = 0;
  std::array<double, 3> weights{};  // of its corners
};

/// The nearest face in each pixel of a view.
std::vector<Hit> rasterised(const TriangleMesh& mesh, const Camera& camera) {
  std::vector<Hit> hits(std::size_t(camera.width_px) * std::size_t(camera.height_px));
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
    std::array<Vec, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec at = camera.to_camera(mesh.at(mesh.faces[f][k]));
      p[k] = {camera.fx * at.x / at.z + camera.cx, camera.fy * at.y / at.z + camera.cy, at.z};
    }
    const double twice = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (p[1].y - p[0].y);
    if (twice == 0) continue;
    const auto bounds = [&](double Vec::*axis, int most) {
      const auto [low, high] = std::minmax({p[0].*axis, p[1].*axis, p[2].*axis});
      return std::array{std::max(0, int(low)), std::min(most, int(high) + 1)};
    };
    const auto [left, right] = bounds(&Vec::x, camera.width_px);
    const auto [top, bottom] = bounds(&Vec::y, camera.height_px);
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x) {
        const auto part = [&](const Vec& a, const Vec& b) {
          return ((a.x - x - 0.5) * (b.y - y - 0.5) - (b.x - x - 0.5) * (a.y - y - 0.5)) / twice;
        };
        const std::array weights{part(p[1], p[2]), part(p[2], p[0]), part(p[0], p[1])};
        if (weights[0] < 0 || weights[1] < 0 || weights[2] < 0) continue;
        const double depth = weights[0] * p[0].z + weights[1] * p[1].z + weights[2] * p[2].z;
        Hit& hit = hits[std::size_t(y) * std::size_t(camera.width_px) + std::size_t(x)];
        if (depth < hit.depth) hit = {depth, f, weights};
      }
  }
  return hits;
}

struct Error2 {
  double sum = 0, count = 0;
  void add(Vec3<float> found, const std::uint8_t* truth) {
    const float colour[3] = {found.x, found.y, found.z};
    for (std::size_t c = 0; c < 3; ++c) sum += std::pow(double(colour[c]) - truth[c] / 255.0, 2);
    count += 3;
  }
  double psnr_db() const { return -10 * std::log10(sum / count); }
};

void run(int argc, char** argv) {
  const GaussianCloud cloud = io::read_gaussian_ply(argv[1]).cloud;
  mesh::MeshOptions options;
  if (argc > 2) options.faces = std::atoi(argv[2]);
  Monitor monitor;
  const Exec exec{.threads = 2};
  const TriangleMesh mesh = mesh::mesh_of(exec, monitor, cloud, options).mesh;
  const auto views = mesh::render_surface_views(
      exec, cloud, {orbit::even_directions(64), orbit::bulk_of(orbit::surface_points(cloud)), 512});
  const mesh::DistanceField field(views, 0.02 * orbit::bulk_of(orbit::surface_points(cloud)).radius, {});
  Error2 vertices, pixels;
  for (std::size_t v = 0; v < views.size(); v += 4) {
    const std::vector<Hit> hits = rasterised(mesh, views[v].camera);
    for (std::size_t p = 0; p < hits.size(); ++p) {
      if (!(hits[p].depth < 1e300 && views[v].depth.data[p] > 0)) continue;
      const auto& face = mesh.faces[hits[p].face];
      Vec3<float> mean{0, 0, 0};
      Vec at{0, 0, 0};
      for (std::size_t k = 0; k < 3; ++k) {
        mean = mean + float(hits[p].weights[k]) * mesh.colours[face[k]];
        at = at + hits[p].weights[k] * mesh.at(face[k]);
      }
      const Vec normal = unit(cross(mesh.at(face[1]) - mesh.at(face[0]), mesh.at(face[2]) - mesh.at(face[0])));
      const auto seen = field.colour(at, normal);
      if (!seen) continue;
      vertices.add(mean, &views[v].colour.data[3 * p]);
      pixels.add(*seen, &views[v].colour.data[3 * p]);
    }
  }
  std::printf("%zu\t%.2f\t%.2f\n", mesh.faces.size(), vertices.psnr_db(), pixels.psnr_db());
}

}  // namespace
}  // namespace ngs::bench

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: ngs_mesh_colours SPLAT [FACES]\n");
    return 2;
  }
  try {
    ngs::bench::run(argc, argv);
    return 0;
  } catch (const ngs::Error& e) {
    std::fprintf(stderr, "ngs_mesh_colours: %s\n", e.what());
    return int(e.code());
  }
}
