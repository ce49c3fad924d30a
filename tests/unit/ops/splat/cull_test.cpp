// Frustum culling before projection is conservative: it never culls a Gaussian that touches a tile.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "ngs/core/rng.h"
#include "ngs/math/stable.h"
#include "ngs/ops/splat/binned_view.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/ops/splat/splat_gaussian.h"
#include "support/projected_view.h"
#include "support/random_splats.h"

namespace ngs {
namespace {

double uniform(double lo, double hi) {
  static std::uint64_t index = 0;
  return lo + (hi - lo) * rng_uniform(11, RngStream::kTest, index++);
}

/// Wide, narrow, off-centre and rotated cameras.
Camera any_camera() {
  Camera camera;
  camera.width_px = int(uniform(1, 300));
  camera.height_px = int(uniform(1, 300));
  camera.fx = std::exp(uniform(2, 7));
  camera.fy = camera.fx * uniform(0.5, 2);
  camera.cx = uniform(-0.5, 1.5) * camera.width_px;
  camera.cy = uniform(-0.5, 1.5) * camera.height_px;
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
    least = std::min(least, ratio);
    most = std::max(most, ratio);
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
        cloud.size = 1;
        cloud.position = g.position;
        cloud.log_scale = g.log_scale;
        const Vec3<float> t = narrowed<float>(view.wide.rotation * view.offset(cloud, 0));
        if (!(t.z > view.camera.near_z)) continue;
        ProjectionContext<float> context;
        const TileRect r = tile_rect(project_gaussian(view.camera, t, {g.rotation, g.log_scale, 9.f}, context), compat,
                                     view.tiles_x, view.tiles_y);
        const bool none = r.x_begin >= r.x_end || r.y_begin >= r.y_end, left_out = view.outside_frustum(cloud, 0);
        empty += none;
        culled += left_out;
        wrong += left_out && !none;
      }
    }
    MESSAGE(culled << " of " << empty << " that touch no tile");
    CHECK(wrong == 0);
    CHECK(empty > 50000);
    CHECK(culled > empty * 2 / 5);
  }
}

namespace {

using test::by_index, test::camera_at, test::for_each_scene, test::random_cloud, test::RandomView;

/// [N] 1: one in `every` of the Gaussians in the upper left corner of the image.
std::vector<std::uint8_t> flagged_in_corner(const RandomView& scene, std::size_t every) {
  std::vector<std::uint8_t> some(std::size_t(scene.cloud.size()), 0);
  const ProjectedView<float> view = project_view({}, scene.view(), scene.camera, scene.options);
  for (std::size_t v = 0; v < view.id.size(); v += every)
    some[view.id[v]] = view.rect[v].x_end <= 3 && view.rect[v].y_end <= 3;
  return some;
}

/// (Gaussian, tile) pairs that remain after culling.
std::int64_t pairs_of(const RandomView& scene, const CullRequest& cull) {
  return BinnedView<float>({}, scene.view(), scene.camera, scene.options, cull).lists().pairs();
}

}  // namespace

TEST_CASE("tiles_touching: labels are bit-identical to those of the full view, other tiles may be skipped") {
  int skipped = 0, drawn = 0;
  for_each_scene([&](RandomView& scene) {
    const std::vector<std::uint8_t> some = flagged_in_corner(scene, 3);
    std::vector<float> label(some.begin(), some.end());
    RenderRequest request{.colour = false, .label = {label.data(), scene.cloud.size(), 1}, .include = scene.included()};
    const RenderedView whole = render({}, scene.cloud, scene.camera, scene.options, request);
    request.tiles_touching = some.data();
    for (const bool prepared : {false, true}) {
      SplatOptions options = scene.options;
      if (prepared) options.prepared = prepare_cloud({}, scene.cloud);
      const RenderedView part = render({.threads = 3}, scene.cloud, scene.camera, options, request);
      CHECK(part.label.data == whole.label.data);
      for (std::size_t p = 0; p < whole.alpha.data.size(); ++p) {
        CHECK((part.alpha.data[p] == whole.alpha.data[p] || part.alpha.data[p] == 0));
        skipped += part.alpha.data[p] != whole.alpha.data[p];
        drawn += part.label.data[p] > 0;
      }
    }
  });
  CHECK(skipped > 100000);
  CHECK(drawn > 1000);
}

TEST_CASE("stop_after: culling Gaussians behind the last labelled one keeps label images bit-identical") {
  std::int64_t pairs = 0, pairs_without_stop = 0;
  for_each_scene([&](RandomView& scene) {
    // Object labels, and fainter labels whose tiles are not requested.
    const std::vector<std::uint8_t> object = flagged_in_corner(scene, 3);
    std::vector<std::uint8_t> some = object;
    for (std::size_t i = 0; i < some.size(); i += 29) some[i] = 1;
    std::vector<float> label(some.size());
    for (std::size_t i = 0; i < some.size(); ++i) label[i] = object[i] ? 1.f : some[i] ? 0.3f : 0.f;
    RenderRequest request;
    request.colour = false;
    request.include = scene.included();
    request.label = {label.data(), scene.cloud.size(), 1};
    request.tiles_touching = object.data();
    const RenderedView whole = render({}, scene.cloud, scene.camera, scene.options, request);
    pairs_without_stop += pairs_of(scene, {.tiles_touching = object.data()});
    request.stop_after = some.data();
    pairs += pairs_of(scene, {.tiles_touching = object.data(), .stop_after = some.data()});
    for (const bool prepared : {false, true}) {
      SplatOptions options = scene.options;
      if (prepared) options.prepared = prepare_cloud({}, scene.cloud);
      CHECK(render({.threads = 3}, scene.cloud, scene.camera, options, request).label.data == whole.label.data);
    }
  });
  CHECK(pairs > 1000);
  CHECK(pairs < pairs_without_stop - 2000);  // faint labels lie at any depth
}

TEST_CASE("tiles_touching: with all Gaussians flagged the full view is rendered, with none it is empty") {
  RandomView scene{random_cloud(3000, 7), camera_at(6), {}, {}};
  std::vector<std::uint8_t> some(3000, 1);
  RenderRequest request;
  const RenderedView whole = render({}, scene.cloud, scene.camera, scene.options, request);
  request.tiles_touching = some.data();
  CHECK(render({}, scene.cloud, scene.camera, scene.options, request).alpha.data == whole.alpha.data);
  std::ranges::fill(some, std::uint8_t(0));
  const RenderedView none = render({}, scene.cloud, scene.camera, scene.options, request);
  CHECK(std::ranges::count(none.alpha.data, 0.f) == std::ssize(none.alpha.data));
}

TEST_CASE("max_depth: exactly the Gaussians nearer than the largest requested depth are projected") {
  for_each_scene([](RandomView& scene) {
    ViewProjector<float> near = view_projector<float>(scene.camera, scene.options);
    near.far_z = 5;
    const ProjectedView<float> all = project_view({}, scene.view(), scene.camera, scene.options);
    std::vector<std::uint32_t> want;
    for (std::size_t v = 0; v < all.id.size(); ++v)
      if (all.depth[v] < 5) want.push_back(all.id[v]);
    CHECK(project_view({}, scene.view(), near).id == want);
    scene.options.prepared = prepare_cloud({}, scene.cloud);
    ImageF limit(scene.camera.width_px, scene.camera.height_px, 1);
    limit.data[17] = 1;
    std::fill(limit.data.begin() + 40, limit.data.end(), 5.f);
    const BinnedView<float> binned({}, scene.view(), scene.camera, scene.options, {.max_depth = &limit});
    std::vector<std::uint32_t> got;
    for (const std::size_t at : by_index(binned.view())) got.push_back(binned.view().id[at]);
    CHECK(got == want);
    CHECK(want.size() < all.id.size());
  });
}

}  // namespace ngs
