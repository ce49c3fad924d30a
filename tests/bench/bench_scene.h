#pragma once
// Scene of the benchmarks: a synthetic cloud of any size, or model and first view of the scene.json named in the
// environment variable NGS_BENCH_SCENE.
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/scene/scene.h"
#include "support/random.h"

namespace ngs::bench {

struct BenchScene {
  GaussianCloud cloud;
  Camera camera;
  ViewMasks masks;  // one object: a disc in the middle of the image
};

/// A ball in front of a wall, made of flat Gaussians as wide as their spacing, with a tail of larger and fainter ones,
/// similar to a trained splat. The scene does not depend on the picture size.
inline GaussianCloud surface_cloud(std::int64_t n) {
  GaussianCloud cloud;
  cloud.resize(n, 0);
  test::Random random(11);
  const double spacing = std::sqrt(24.0 / double(n));  // world: about 24 square units of surface
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = std::size_t(i);
    float* p = &cloud.position[k * 3];
    if (i % 2 == 0) {
      const double z = random.uniform(-1, 1), phi = random.uniform(0, 2 * std::numbers::pi), r = std::sqrt(1 - z * z);
      p[0] = float(r * std::cos(phi));
      p[1] = float(r * std::sin(phi));
      p[2] = float(4 + z);
    } else {
      p[0] = float(random.uniform(-2.6, 2.6));
      p[1] = float(random.uniform(-2, 2));
      p[2] = float(random.uniform(6, 6.05));
    }
    const double size = spacing * std::exp(random.uniform(-1, 0.7)) * (i % 29 == 0 ? 4 : 1);
    for (std::size_t a = 0; a < 3; ++a) {
      cloud.log_scale[k * 3 + a] = float(std::log(size) - (a == 2 ? 1.5 : random.uniform(0, 0.7)));
      cloud.sh_dc[k * 3 + a] = float(random.uniform(-1.5, 1.5));
    }
    for (std::size_t a = 0; a < 4; ++a) cloud.rotation[k * 4 + a] = float(random.uniform(-1, 1));
    cloud.logit_opacity[k] = float(i % 3 == 0 ? random.uniform(-4, -1) : random.uniform(-1, 4));
  }
  return cloud;
}

inline Camera bench_camera(int width_px, int height_px) {
  const double focal_px = 1.2 * width_px;
  Camera camera{"", width_px, height_px, focal_px, focal_px, 0.5 * width_px + 1.3, 0.5 * height_px - 0.7};
  camera.rotation = {{1, 0, 0, 0, 1, 0, 0, 0, 1}};
  return camera;
}

inline BenchScene bench_scene(std::int64_t gaussians, int width_px, int height_px) {
  BenchScene scene;
  if (const char* path = std::getenv("NGS_BENCH_SCENE")) {
    const Scene real = io::read_scene_json(path);
    scene.cloud = io::read_gaussian_ply(real.model_path).cloud;
    scene.camera = real.views.front().camera;
  } else {
    scene.cloud = surface_cloud(gaussians);
    scene.camera = bench_camera(width_px, height_px);
  }
  const int w = scene.camera.width_px, h = scene.camera.height_px;
  scene.masks.width_px = w;
  scene.masks.height_px = h;
  scene.masks.available = true;
  scene.masks.target.emplace_back(std::size_t(w) * std::size_t(h));
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      scene.masks.target[0][std::size_t(y) * std::size_t(w) + std::size_t(x)] =
          std::hypot(x - w / 2, y - h / 2) < 0.25 * w ? 1.f : 0.f;
  return scene;
}

}  // namespace ngs::bench
