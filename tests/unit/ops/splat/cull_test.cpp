// Frustum culling before projection is conservative: it never culls a Gaussian that touches a tile.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "ngs/core/rng.h"
#include "ngs/math/stable.h"
#include "ngs/ops/splat/splat_gaussian.h"

namespace ngs {
namespace {

double uniform(double lo, double hi) {
  static std::uint64_t index = 0;
  return lo + (hi - lo) * rng_uniform(11, RngStream::kTest, index++);
}

/// Wide, narrow, off-centre and rotated cameras.
Camera any_camera() {
  Camera camera;
  camera.width_px = int(uniform(1, 300)), camera.height_px = int(uniform(1, 300));
  camera.fx = std::exp(uniform(2, 7)), camera.fy = camera.fx * uniform(0.5, 2);
  camera.cx = uniform(-0.5, 1.5) * camera.width_px, camera.cy = uniform(-0.5, 1.5) * camera.height_px;
  const double angle = uniform(-3, 3), c = std::cos(angle), s = std::sin(angle);
  camera.rotation = {{c, 0, s, 0, 1, 0, -s, 0, c}};
  return camera;
}

struct Any {
  float position[3], rotation[4], log_scale[3];
};

/// Near the border of the image, at any depth, from pixel to image size, round, flat or elongated.
Any any_gaussian(const Camera& camera) {
  const double z = std::exp(uniform(-1.6, 5)), px = z / camera.fx;
  const double x = (uniform(-2, 3) * camera.width_px - camera.cx) * px,
               y = (uniform(-2, 3) * camera.height_px - camera.cy) * z / camera.fy;
  const Vec3<double> p = transpose(camera.rotation) * Vec3<double>{x, y, z};
  Any g{{float(p.x), float(p.y), float(p.z)}, {}, {}};
  for (float& q : g.rotation) q = float(uniform(-1, 1));
  for (float& s : g.log_scale) s = float(std::log(px) + uniform(-4, 6));
  return g;
}

}  // namespace

TEST_CASE("cull: exp_at_least is an upper bound of exp within 6.3 %") {
  double least = 2, most = 0;
  for (float x = -87; x <= 88; x += 1e-4f) {
    const double ratio = double(exp_at_least(x)) / std::exp(double(x));
    least = std::min(least, ratio), most = std::max(most, ratio);
  }
  MESSAGE("exp_at_least over exp: " << least << " to " << most);
  CHECK(least >= 1);
  CHECK(most < 1.063);
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (const float x : {-1e30f, -kInf, std::numeric_limits<float>::quiet_NaN()})
    CHECK(exp_at_least(x) == exp_at_least(-87.f));
  for (const float x : {1e30f, kInf}) CHECK(exp_at_least(x) == exp_at_least(88.f));
}

TEST_CASE(
    "cull: no culled Gaussian touches a tile; near the border at least 40 % of those that touch none are culled") {
  for (const Compat compat : {Compat::kInria, Compat::kGsplat}) {
    std::int64_t culled = 0, empty = 0, wrong = 0;
    for (int c = 0; c < 200; ++c) {
      const Camera camera = any_camera();
      const ViewProjector<float> view = view_projector<float>(camera, {.compat = compat, .blur_px2 = uniform(0, 2)});
      for (int k = 0; k < 1000; ++k) {
        const Any g = any_gaussian(camera);
        CloudView<float> cloud;
        cloud.size = 1, cloud.position = g.position, cloud.log_scale = g.log_scale;
        const Vec3<float> t = narrowed<float>(view.wide.rotation * view.offset(cloud, 0));
        if (!(t.z > view.camera.near_z)) continue;
        ProjectionContext<float> context;
        const TileRect r = tile_rect(project_gaussian(view.camera, t, {g.rotation, g.log_scale, 9.f}, context), compat,
                                     view.tiles_x, view.tiles_y);
        const bool none = r.x_begin >= r.x_end || r.y_begin >= r.y_end, left_out = view.outside_frustum(cloud, 0);
        empty += none, culled += left_out, wrong += left_out && !none;
      }
    }
    MESSAGE(culled << " of " << empty << " that touch no tile");
    CHECK(wrong == 0);
    CHECK(empty > 50000);
    CHECK(culled > empty * 2 / 5);
  }
}

}  // namespace ngs
