#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <numeric>
#include <random>

#include "ngs/math/curve_order.h"
#include "ngs/ops/splat/evidence.h"
#include "ngs/ops/splat/prepared/curve_blocks.h"
#include "support/projected_view.h"
#include "support/random_splats.h"

namespace ngs {
namespace {

using test::by_index, test::camera_at, test::for_each_scene, test::random_cloud, test::kInf, test::kNan;
using View = test::RandomView;

template <class T>
bool same_bytes(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

/// Gaussian -> its weight and its weight inside the object.
using Weights = std::map<std::uint32_t, std::pair<double, double>>;

Weights unpacked(const PackedSums& packed) {
  Weights all;
  for (std::size_t part = 0; part < packed.parts(); ++part)
    packed.for_each(part, [&](std::uint32_t gaussian, const double* weight) {
      CHECK(all.emplace(gaussian, std::pair(weight[0], weight[1])).second);
    });
  return all;
}

/// Whether row `at` of the block projection equals row v of the scalar projection.
bool same_row(const ProjectedView<float>& blocks, std::size_t at, const ProjectedView<float>& want, std::size_t v) {
  return blocks.id[at] == want.id[v] && same_bytes(blocks.record[at], want.record[v]) &&
         blocks.depth[at] == want.depth[v] && same_bytes(blocks.rect[at], want.rect[v]) &&
         same_bytes(blocks.first[at], want.first[v]);
}

}  // namespace

TEST_CASE("prepared cloud: block projection is bit-identical to the scalar projection") {
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

TEST_CASE("prepared cloud: blocks have small bounding boxes for rows in random order") {
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

TEST_CASE("prepared cloud: after update_prepared() renders equal those of the changed cloud") {
  for_each_scene([](View& scene) {
    scene.options.prepared.reset();
    const auto prepared = prepare_cloud({}, scene.cloud);
    for (int round = 0; round < 2; ++round) {
      std::vector<std::int64_t> rows;
      for (std::int64_t i = 5 + round; i < scene.cloud.size(); i += 7) rows.push_back(i);
      for (const std::int64_t i : rows) {
        scene.cloud.position[std::size_t(3 * i)] += 0.5f;
        scene.cloud.logit_opacity[std::size_t(i)] += 1.f;
      }
      update_prepared({.threads = 3}, rows, *prepared);
      SplatOptions updated = scene.options;
      updated.prepared = prepared;
      RenderRequest request{.label = {}, .include = scene.included()};
      const RenderedView want = render({}, scene.cloud, scene.camera, scene.options, request),
                         got = render({}, scene.cloud, scene.camera, updated, request);
      CHECK(std::memcmp(got.colour.data.data(), want.colour.data.data(), want.colour.data.size() * sizeof(float)) == 0);
    }
  });
}

TEST_CASE("prepared cloud: culled groups of blocks reappear when their rows move in front of the camera") {
  GaussianCloud cloud = random_cloud(20000, 5);
  for (std::size_t i = 3 * 10000; i < 3 * 20000; ++i) cloud.position[i] -= 1e4f;  // behind the camera
  const auto prepared = prepare_cloud({}, cloud);
  CHECK(prepared->groups() > 3);
  SplatOptions with{.prepared = prepared};
  const auto same_rows = [&] {
    const CloudView<float> view = cloud_view(cloud, 0, nullptr);
    const ProjectedView<float> want = project_view({}, view, camera_at(6), {});
    const BinnedView<float> got({.threads = 3}, view, camera_at(6), with);
    const std::vector<std::size_t> order = by_index(got.view());
    REQUIRE(order.size() == want.id.size());
    for (std::size_t v = 0; v < order.size(); ++v) REQUIRE(same_row(got.view(), order[v], want, v));
    return std::int64_t(order.size());
  };
  const std::int64_t before = same_rows();
  std::vector<std::int64_t> rows;
  for (std::size_t i = 3 * 10000; i < 3 * 20000; ++i) cloud.position[i] += 1e4f;
  for (std::int64_t i = 10000; i < 20000; ++i) rows.push_back(i);
  update_prepared({}, rows, *prepared);
  CHECK(same_rows() > before + 5000);
}

TEST_CASE("prepared cloud: renders and evidence are bit-identical to those of the plain cloud") {
  for_each_scene([](const View& scene) {
    SplatOptions prepared = scene.options;
    prepared.prepared = prepare_cloud({}, scene.cloud);
    RenderRequest request{.depth = true, .label = {}, .include = scene.included()};
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
      CHECK(unpacked(packed_sums({.threads = threads}, scene.cloud, {scene.camera, masks}, prepared)) ==
            unpacked(packed_sums({}, scene.cloud, {scene.camera, masks}, scene.options)));
    }
  });
}

TEST_CASE("prepared cloud: it serves only the cloud that it was made from") {
  const GaussianCloud cloud = random_cloud(300, 1), other = random_cloud(300, 1);
  const auto prepared = prepare_cloud({}, cloud);
  CHECK(prepared->serves(cloud_view(cloud, 3, nullptr)));
  CHECK_FALSE(prepared->serves(cloud_view(other, 3, nullptr)));
}

TEST_CASE("tile lists: depth order with ties by index, for few and for many Gaussians per tile") {
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

TEST_CASE("tile lists: equal depths are ordered by index into the cloud for any order of the view") {
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
      shuffled.id.push_back(view.id[v]);
      shuffled.record.push_back(view.record[v]);
      shuffled.depth.push_back(view.depth[v]);
      shuffled.rect.push_back(view.rect[v]);
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

TEST_CASE("tile lists: every (Gaussian, tile) intersection is listed once, with consecutive slots per Gaussian") {
  for (const float log_scale : {-5.f, -1.f, 0.5f})  // one or two tiles; several; rows beyond the first ones
    for (const std::array<int, 2> size : {std::array{150, 90}, std::array{11, 200}, std::array{200, 13}}) {
      const int width_px = size[0], height_px = size[1];
      CAPTURE(log_scale);
      CAPTURE(width_px);
      GaussianCloud cloud = random_cloud(2000, 5);
      for (float& s : cloud.log_scale) s += log_scale;
      Camera camera = camera_at(6);
      camera.width_px = width_px;
      camera.height_px = height_px;
      camera.cx = width_px / 2.0;
      camera.cy = height_px / 2.0;
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

TEST_CASE("parallel_curve_order equals curve_order row for row, for any number of threads") {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  for (const std::size_t n : {0, 1, 255, 3000, 200000}) {
    CAPTURE(n);
    std::mt19937 random(unsigned(n + 1));
    std::uniform_real_distribution<float> uniform;
    std::vector<float> points;
    for (std::size_t i = 0; i < n; ++i) {
      // A cluster, distant outliers, coincident points and NaNs.
      const float reach = i % 7 == 0 ? 1000.f : i % 5 == 0 ? 0.f : 1.f;
      for (int a = 0; a < 3; ++a) points.push_back(i % 11 == 3 ? kNan : reach * uniform(random));
    }
    const std::vector<std::uint32_t> want = curve_order(points);
    for (const int threads : {1, 3}) {
      const RawColumn<std::uint32_t> got = parallel_curve_order({.threads = threads}, points);
      REQUIRE(got.size() == want.size());
      CHECK(std::equal(got.begin(), got.end(), want.begin()));
    }
  }
}

}  // namespace ngs
