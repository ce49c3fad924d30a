#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <numeric>
#include <random>

#include "ngs/ops/splat/binned_view.h"
#include "ngs/ops/splat/cloud_view.h"
#include "ngs/ops/splat/evidence.h"

namespace ngs {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();

/// Around the origin, most within 3 of it; sizes from specks to ones larger than the scene.
GaussianCloud random_cloud(std::int64_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  GaussianCloud cloud;
  cloud.resize(n, 1);
  for (float& x : cloud.position) x = 1.5f * normal(random);
  for (float& x : cloud.rotation) x = normal(random);
  for (float& x : cloud.log_scale) x = -3.f + 1.5f * normal(random);
  for (float& x : cloud.logit_opacity) x = 3.f * normal(random);
  for (float& x : cloud.sh_dc) x = normal(random);
  for (float& x : cloud.sh_rest) x = 0.2f * normal(random);
  return cloud;
}

/// Every tenth row is one that arithmetic may stumble over; `usable` does not say so.
void make_hostile(GaussianCloud& cloud) {
  const float hostile[] = {kNan, kInf, -kInf, 0.f, 1e30f, -1e30f, 1e-40f, 39.f, -120.f};
  const std::size_t kinds = std::size(hostile);
  for (std::size_t i = 0; i < std::size_t(cloud.size()); i += 10) {
    const float value = hostile[i / 10 % kinds];
    switch (i / 10 / kinds % 6) {
      case 0: cloud.position[3 * i + i % 3] = value; break;
      case 1: cloud.rotation[4 * i + i % 4] = value; break;
      case 2: cloud.log_scale[3 * i + i % 3] = value; break;
      case 3: cloud.logit_opacity[i] = value; break;
      case 4: std::fill_n(&cloud.log_scale[3 * i], 3, value); break;
      default: std::fill_n(&cloud.rotation[4 * i], 4, value);
    }
  }
}

Camera camera_at(double z) {
  Camera camera;
  camera.width_px = 150, camera.height_px = 90;
  camera.fx = 120, camera.fy = 118, camera.cx = 70.5, camera.cy = 46.25;
  camera.rotation = {{1, 0, 0, 0, 0.8, -0.6, 0, 0.6, 0.8}};
  camera.translation = {0.1, -0.2, z};
  return camera;
}

struct View {
  GaussianCloud cloud;
  Camera camera;
  SplatOptions options;
  std::vector<std::uint8_t> include;  // empty: all
  const std::uint8_t* included() const { return include.empty() ? nullptr : include.data(); }
  CloudView<float> view() const { return cloud_view(cloud, 1, included()); }
};

/// f(scene) for clouds, cameras in front of and inside them, both families, filters and lists of the included.
template <class F>
void for_each_scene(const F& f) {
  for (const bool hostile : {false, true})
    for (const double z : {6.0, 0.5})
      for (const Compat compat : {Compat::kInria, Compat::kGsplat})
        for (const bool antialiased : {false, true})
          for (const std::size_t every : {0, 2, 40}) {
            INFO("hostile ", hostile, ", z ", z, ", compat ", int(compat), ", antialiased ", antialiased, ", one of ",
                 every);
            View scene{random_cloud(3000, 7), camera_at(z), {.compat = compat, .antialiased = antialiased}, {}};
            if (hostile) make_hostile(scene.cloud);
            for (std::size_t i = 0; every > 0 && i < 3000; ++i) scene.include.push_back(i % every == 0);
            for (std::size_t i = 0; i < 100; ++i) scene.cloud.usable[7 * i] = 0;
            f(scene);
          }
}

template <class T>
bool same_bytes(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

/// The rows of a view that reach a tile, by their index into the cloud.
std::vector<std::size_t> by_index(const ProjectedView<float>& view) {
  std::vector<std::size_t> order;
  for (std::size_t at = 0; at < view.id.size(); ++at)
    if (view.rect[at].x_begin != view.rect[at].x_end) order.push_back(at);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return view.id[a] < view.id[b]; });
  return order;
}

/// Gaussian, its weight and that of the object.
using Weights = std::map<std::uint32_t, std::pair<double, double>>;

Weights unpacked(const ViewWeights& packed) {
  Weights all;
  for (std::size_t part = 0; part < packed.parts(); ++part)
    packed.for_each(part, [&](std::uint32_t gaussian, const double* weight) {
      CHECK(all.emplace(gaussian, std::pair(weight[0], weight[1])).second);
    });
  return all;
}

/// Whether row `at` of the blocks' view is row v of the scalar one's.
bool same_row(const ProjectedView<float>& blocks, std::size_t at, const ProjectedView<float>& want, std::size_t v) {
  return blocks.id[at] == want.id[v] && same_bytes(blocks.record[at], want.record[v]) &&
         blocks.depth[at] == want.depth[v] && same_bytes(blocks.rect[at], want.rect[v]) &&
         same_bytes(blocks.first[at], want.first[v]);
}

}  // namespace

TEST_CASE("prepared cloud: blocks project to the bits of the scalar projection") {
  for_each_scene([](View& scene) {
    const ProjectedView<float> want = project_view({}, scene.view(), scene.camera, scene.options);
    scene.options.prepared = prepare_cloud({}, scene.cloud);
    const BinnedView<float> binned({.threads = 3}, scene.view(), scene.camera, scene.options);
    const ProjectedView<float>& got = binned.view();
    const std::vector<std::size_t> order = by_index(got);
    CHECK(want.id.size() > 5);
    REQUIRE(order.size() == want.id.size());
    std::size_t differ = 0;
    for (std::size_t v = 0; v < order.size(); ++v) differ += !same_row(got, order[v], want, v);
    CHECK(differ == 0);
  });
}

TEST_CASE("prepared cloud: a block lies in a small box whatever order the rows have") {
  GaussianCloud cloud = random_cloud(40000, 11);  // in no order
  for (const float value : {kNan, kInf, -kInf}) cloud.position[3 * 17 + std::size_t(std::isfinite(value))] = value;
  const auto prepared = prepare_cloud({.threads = 3}, cloud);
  std::vector<std::uint8_t> times(std::size_t(cloud.size()), 0);
  for (const std::uint32_t row : prepared->row) ++times[row];
  CHECK(std::count(times.begin(), times.end(), 1) == cloud.size());
  CHECK(prepared->row.back() == 17);  // it has no place
  double mean = 0;
  for (const BlockBounds& b : prepared->bounds) {
    if (b.empty()) continue;
    const double diagonal = std::hypot(b.hi[0] - b.lo[0], b.hi[1] - b.lo[1], b.hi[2] - b.lo[2]);
    if (std::isfinite(diagonal)) mean += diagonal / double(prepared->blocks());
  }
  // 256 of 40,000 normally distributed centres (deviation 1.5) in index order span a diagonal of about 14; a cube with
  // the 256 nearest to the origin has one of 1.3. A block may have a leap of the curve in it.
  CHECK(mean < 4);
}

TEST_CASE("prepared cloud: rows that change are told, wherever they lie") {
  for_each_scene([](View& scene) {
    scene.options.prepared.reset();
    const auto prepared = prepare_cloud({}, scene.cloud);
    for (int round = 0; round < 2; ++round) {
      std::vector<std::int64_t> rows;
      for (std::int64_t i = 5 + round; i < scene.cloud.size(); i += 7) rows.push_back(i);
      for (const std::int64_t i : rows)
        scene.cloud.position[std::size_t(3 * i)] += 0.5f, scene.cloud.logit_opacity[std::size_t(i)] += 1.f;
      update_prepared({.threads = 3}, rows, *prepared);
      SplatOptions told = scene.options;
      told.prepared = prepared;
      RenderRequest request;
      request.include = scene.included();
      const RenderedView want = render({}, scene.cloud, scene.camera, scene.options, request),
                         got = render({}, scene.cloud, scene.camera, told, request);
      CHECK(std::memcmp(got.colour.data.data(), want.colour.data.data(), want.colour.data.size() * sizeof(float)) == 0);
    }
  });
}

TEST_CASE("prepared cloud: pictures and evidence keep their bits") {
  for_each_scene([](const View& scene) {
    SplatOptions prepared = scene.options;
    prepared.prepared = prepare_cloud({}, scene.cloud);
    RenderRequest request;
    request.depth = true, request.include = scene.included();
    const auto pixels = std::size_t(scene.camera.width_px * scene.camera.height_px);
    const ViewMasks masks{scene.camera.width_px, scene.camera.height_px, {std::vector<float>(pixels, 0.75f)}, {}, true};
    for (const int threads : {1, 3}) {
      const RenderedView want = render({}, scene.cloud, scene.camera, scene.options, request),
                         got = render({.threads = threads}, scene.cloud, scene.camera, prepared, request);
      CHECK(std::memcmp(got.colour.data.data(), want.colour.data.data(), pixels * 3 * sizeof(float)) == 0);
      CHECK(std::memcmp(got.depth.data.data(), want.depth.data.data(), pixels * sizeof(float)) == 0);
      const ViewSums sums = view_sums({}, scene.cloud, {scene.camera, masks}, scene.options),
                     same = view_sums({.threads = threads}, scene.cloud, {scene.camera, masks}, prepared);
      CHECK(sums.size() > 5);
      CHECK(same.row == sums.row);
      CHECK(same.sum == sums.sum);
      CHECK(unpacked(view_weights({.threads = threads}, scene.cloud, {scene.camera, masks}, prepared)) ==
            unpacked(view_weights({}, scene.cloud, {scene.camera, masks}, scene.options)));
    }
  });
}

TEST_CASE("prepared cloud: serves no other cloud") {
  const GaussianCloud cloud = random_cloud(300, 1), other = cloud;
  const auto prepared = prepare_cloud({}, cloud);
  CHECK(prepared->serves(cloud_view(cloud, 3, nullptr)));
  CHECK_FALSE(prepared->serves(cloud_view(other, 3, nullptr)));
}

TEST_CASE("tile lists: nearest first, equal depths by index, for few and for many in a tile") {
  for (const std::int64_t n : {3, 100, 5000}) {
    GaussianCloud cloud = random_cloud(n, 3);
    for (std::size_t i = 0; i < std::size_t(n); ++i) cloud.position[3 * i + 2] = 0.5f * float(i * 7 % 5);
    const ProjectedView<float> view = project_view({}, cloud_view(cloud, 0, nullptr), camera_at(6), {});
    const TileLists lists = bin_tiles({.threads = 2}, view, 150, 90);
    std::int64_t disorder = 0, wrong_slots = 0;
    for (std::int64_t tile = 0; tile < lists.tiles(); ++tile)
      for (std::int64_t e = lists.tile_begin[std::size_t(tile)]; e < lists.tile_begin[std::size_t(tile) + 1]; ++e) {
        const std::size_t v = lists.visible[std::size_t(e)], slot = lists.slot[std::size_t(e)];
        wrong_slots += std::int64_t(slot) < lists.slot_begin[v] || std::int64_t(slot) >= lists.slot_begin[v + 1];
        if (e == lists.tile_begin[std::size_t(tile)]) continue;
        const std::size_t before = lists.visible[std::size_t(e) - 1];
        disorder += std::pair(view.depth[before], before) >= std::pair(view.depth[v], v);
      }
    CHECK(lists.pairs() >= n / 2);
    CHECK(disorder == 0);
    CHECK(wrong_slots == 0);
  }
}

TEST_CASE("tile lists: equal depths by index into the cloud, whatever order the view has") {
  for (const std::int64_t n : {40, 5000}) {
    GaussianCloud cloud = random_cloud(n, 3);
    for (std::size_t i = 0; i < std::size_t(n); ++i) cloud.position[3 * i + 2] = 0.5f * float(i * 7 % 5);
    Camera camera = camera_at(6);
    camera.rotation = {{1, 0, 0, 0, 1, 0, 0, 0, 1}};  // depth is z alone
    const ProjectedView<float> view = project_view({}, cloud_view(cloud, 0, nullptr), camera, {});
    ProjectedView<float> shuffled;
    std::vector<std::size_t> order(view.id.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::shuffle(order.begin(), order.end(), std::mt19937(5));
    for (const std::size_t v : order) {
      shuffled.id.push_back(view.id[v]), shuffled.record.push_back(view.record[v]);
      shuffled.depth.push_back(view.depth[v]), shuffled.rect.push_back(view.rect[v]);
      shuffled.first.push_back(view.first[v]);
    }
    const TileLists want = bin_tiles({}, view, 150, 90), got = bin_tiles({.threads = 3}, shuffled, 150, 90);
    REQUIRE(want.pairs() > n / 2);
    CHECK(got.tile_begin == want.tile_begin);
    std::vector<std::uint32_t> want_id, got_id;
    for (const std::uint32_t v : want.visible) want_id.push_back(view.id[v]);
    for (const std::uint32_t v : got.visible) got_id.push_back(shuffled.id[v]);
    CHECK(got_id == want_id);
  }
}

TEST_CASE("tile lists: every pair of a Gaussian and a tile that it reaches is listed once, its slots in order") {
  for (const float log_scale : {-5.f, -1.f, 0.5f})  // one or two tiles; several; rows beyond the first ones
    for (const auto& [width_px, height_px] : {std::pair(150, 90), std::pair(11, 200), std::pair(200, 13)}) {
      CAPTURE(log_scale);
      CAPTURE(width_px);
      GaussianCloud cloud = random_cloud(2000, 5);
      for (float& s : cloud.log_scale) s += log_scale;
      Camera camera = camera_at(6);
      camera.width_px = width_px, camera.height_px = height_px;
      camera.cx = width_px / 2.0, camera.cy = height_px / 2.0;
      const ProjectedView<float> view = project_view({}, cloud_view(cloud, 0, nullptr), camera, {});
      std::vector<std::pair<std::int64_t, std::uint32_t>> want, got;  // tile, v; by slot
      for (std::uint32_t v = 0; v < view.id.size(); ++v)
        for (int ty = view.rect[v].y_begin; ty < view.rect[v].y_end; ++ty) {
          const TileSpan span = tile_span(view.record[v], view.rect[v], ty);
          for (int tx = span.first; tx < span.end; ++tx) want.emplace_back(ty * ((width_px + 15) / 16) + tx, v);
        }
      for (const int threads : {1, 3}) {
        const TileLists lists = bin_tiles({.threads = threads}, view, width_px, height_px);
        got.assign(std::size_t(lists.pairs()), {-1, 0});
        for (std::int64_t tile = 0; tile < lists.tiles(); ++tile)
          for (auto e = std::size_t(lists.tile_begin[std::size_t(tile)]);
               e < std::size_t(lists.tile_begin[std::size_t(tile) + 1]); ++e)
            got[lists.slot[e]] = {tile, lists.visible[e]};
        CHECK(want.size() > 200);
        CHECK(got == want);
      }
    }
}

/// [N] 1: one Gaussian in `every`, of those in the upper left eighth of the picture.
std::vector<std::uint8_t> some_in_a_corner(const View& scene, std::size_t every) {
  std::vector<std::uint8_t> some(std::size_t(scene.cloud.size()), 0);
  const ProjectedView<float> view = project_view({}, scene.view(), scene.camera, scene.options);
  for (std::size_t v = 0; v < view.id.size(); v += every)
    some[view.id[v]] = view.rect[v].x_end <= 3 && view.rect[v].y_end <= 3;
  return some;
}

TEST_CASE("where a view is looked at only about some Gaussians, their tiles are those of the whole view to the bit") {
  int left_out = 0, drawn = 0;
  for_each_scene([&](View& scene) {
    const std::vector<std::uint8_t> some = some_in_a_corner(scene, 3);
    std::vector<float> label(some.begin(), some.end());
    RenderRequest request;
    request.colour = false, request.include = scene.included();
    request.label = {label.data(), scene.cloud.size(), 1};
    const RenderedView whole = render({}, scene.cloud, scene.camera, scene.options, request);
    request.where = some.data();
    for (const bool prepared : {false, true}) {
      SplatOptions options = scene.options;
      if (prepared) options.prepared = prepare_cloud({}, scene.cloud);
      const RenderedView part = render({.threads = 3}, scene.cloud, scene.camera, options, request);
      CHECK(part.label.data == whole.label.data);
      for (std::size_t p = 0; p < whole.alpha.data.size(); ++p) {
        CHECK((part.alpha.data[p] == whole.alpha.data[p] || part.alpha.data[p] == 0));
        left_out += part.alpha.data[p] != whole.alpha.data[p], drawn += part.label.data[p] > 0;
      }
    }
  });
  CHECK(left_out > 100000);
  CHECK(drawn > 1000);
}

TEST_CASE("where most of a model is asked of, or none of it, a view is drawn as a whole, or not at all") {
  View scene{random_cloud(3000, 7), camera_at(6), {}, {}};
  std::vector<std::uint8_t> some(3000, 1);
  RenderRequest request;
  const RenderedView whole = render({}, scene.cloud, scene.camera, scene.options, request);
  request.where = some.data();
  CHECK(render({}, scene.cloud, scene.camera, scene.options, request).alpha.data == whole.alpha.data);
  std::ranges::fill(some, std::uint8_t(0));
  const RenderedView none = render({}, scene.cloud, scene.camera, scene.options, request);
  CHECK(std::ranges::count(none.alpha.data, 0.f) == std::ssize(none.alpha.data));
}

TEST_CASE("nothing of a view that is as far as it is asked of is projected, and all that is nearer") {
  for_each_scene([](View& scene) {
    CloudView<float> near = scene.view();
    near.far_z = 5;
    const ProjectedView<float> all = project_view({}, scene.view(), scene.camera, scene.options);
    std::vector<std::uint32_t> want;
    for (std::size_t v = 0; v < all.id.size(); ++v)
      if (all.depth[v] < 5) want.push_back(all.id[v]);
    CHECK(project_view({}, near, scene.camera, scene.options).id == want);
    scene.options.prepared = prepare_cloud({}, scene.cloud);
    const BinnedView<float> binned({}, near, scene.camera, scene.options);
    std::vector<std::uint32_t> got;
    for (const std::size_t at : by_index(binned.view())) got.push_back(binned.view().id[at]);
    CHECK(got == want);
    CHECK(want.size() < all.id.size());
  });
}

}  // namespace ngs
