#include <doctest/doctest.h>

#include "ngs/ops/splat/binned_view.h"
#include "ngs/ops/splat/splat.h"
#include "support/projected_view.h"
#include "support/random_splats.h"

namespace ngs {
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
    RenderRequest request;
    request.colour = false, request.include = scene.included();
    request.label = {label.data(), scene.cloud.size(), 1};
    const RenderedView whole = render({}, scene.cloud, scene.camera, scene.options, request);
    request.tiles_touching = some.data();
    for (const bool prepared : {false, true}) {
      SplatOptions options = scene.options;
      if (prepared) options.prepared = prepare_cloud({}, scene.cloud);
      const RenderedView part = render({.threads = 3}, scene.cloud, scene.camera, options, request);
      CHECK(part.label.data == whole.label.data);
      for (std::size_t p = 0; p < whole.alpha.data.size(); ++p) {
        CHECK((part.alpha.data[p] == whole.alpha.data[p] || part.alpha.data[p] == 0));
        skipped += part.alpha.data[p] != whole.alpha.data[p], drawn += part.label.data[p] > 0;
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
    request.colour = false, request.include = scene.included();
    request.label = {label.data(), scene.cloud.size(), 1}, request.tiles_touching = object.data();
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
    limit.data[17] = 1, std::fill(limit.data.begin() + 40, limit.data.end(), 5.f);
    const BinnedView<float> binned({}, scene.view(), scene.camera, scene.options, {.max_depth = &limit});
    std::vector<std::uint32_t> got;
    for (const std::size_t at : by_index(binned.view())) got.push_back(binned.view().id[at]);
    CHECK(got == want);
    CHECK(want.size() < all.id.size());
  });
}

}  // namespace ngs
