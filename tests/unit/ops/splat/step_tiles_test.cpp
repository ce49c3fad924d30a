#include "ngs/ops/splat/step_tiles.h"

#include <doctest/doctest.h>

#include <numeric>

#include "ngs/ops/splat/splat.h"
#include "ngs/ops/splat/tile_types.h"
#include "support/random_splats.h"

namespace ngs {
namespace {

/// Masks of 80 x 48 pixels whose contour is the column x = 20.
ViewMasks half_masks() {
  ViewMasks masks{80, 48, {std::vector<float>(80 * 48)}, {}, true};
  for (std::size_t p = 0; p < masks.target[0].size(); ++p) masks.target[0][p] = p % 80 < 20 ? 1.f : 0.f;
  return masks;
}

std::vector<float> all_columns(const CloudGradients& g) {
  std::vector<float> all;
  for (const auto* column : {&g.position, &g.rotation, &g.log_scale, &g.logit_opacity, &g.sh_dc, &g.sh_rest})
    all.insert(all.end(), column->begin(), column->end());
  return all;
}

}  // namespace

TEST_CASE("step_tiles: tiles with a contour within 8 pixels are near; without masks all tiles are rendered") {
  CHECK(contour_tiles(half_masks()) == TileFlags{1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 1, 1, 0, 0, 0});
  CHECK(contour_tiles({}).empty());
}

TEST_CASE("step_tiles: near tiles weigh 1 in every step, the others 1 in the mean") {
  const TileFlags near = contour_tiles(half_masks());
  std::vector<double> mean(near.size());
  constexpr int kSteps = 1000;
  double mean_weight = 0;
  for (int step = 0; step < kSteps; ++step) {
    const StepTiles tiles = step_tiles(near, 80, 48, 1, step);
    ImageF image(80, 48, 1);
    weigh_pixels({}, near, tiles, image);
    CHECK(std::accumulate(image.data.begin(), image.data.end(), 0.0) == tiles.weight);
    mean_weight += tiles.weight / double(image.pixels()) / kSteps;
    for (std::size_t t = 0; t < near.size(); ++t) {
      const float weight = image.at(int(t % 5) * kTilePx + 3, int(t / 5) * kTilePx + 15);
      CHECK(tiles.rendered[t] == (weight > 0));
      if (near[t]) CHECK(weight == 1);
      mean[t] += double(weight) / kSteps;
    }
  }
  for (const double weight : mean) CHECK(weight == doctest::Approx(1).epsilon(0.2));
  CHECK(mean_weight == doctest::Approx(1).epsilon(0.05));
}

TEST_CASE("SplatPass: gradients of a pass over some tiles are those of the full pass whose other pixels have no loss") {
  using test::random_cloud;
  const GaussianCloud cloud = random_cloud(2000, 5);
  const Camera camera = test::camera_at(6);
  TileFlags near(std::size_t(tiles_across(camera.width_px) * tiles_across(camera.height_px)), 0);
  near[1] = 1;
  const StepTiles tiles = step_tiles(near, camera.width_px, camera.height_px, 3, 0);
  ImageF weight(camera.width_px, camera.height_px, 1);
  weigh_pixels({}, near, tiles, weight);
  SplatOptions options{.prepared = prepare_cloud({}, cloud)};
  CloudGradients gradients[2];
  ViewGradients image;
  for (const bool some : {false, true}) {
    SplatPass pass(options);
    RenderRequest request;
    if (some) request.tiles = tiles.rendered.data();
    RenderedView& view = pass.forward({.threads = 3}, cloud, camera, request);
    const std::vector<float> target(view.colour.data.size(), 0.25f);
    const ImageF rendered = view.colour;
    keep_weighted({}, weight, &target, view.colour);
    std::size_t skipped = 0;
    for (std::size_t i = 0; i < target.size(); ++i) {
      const bool kept = weight.data[i / 3] > 0;
      CHECK(view.colour.data[i] == (kept ? rendered.data[i] : 0.25f));
      skipped += !kept;
    }
    CHECK(skipped > 0);
    image.colour = view.colour;
    for (float& g : image.colour.data) g -= 0.25f;  // zero where the target was kept
    pass.backward({.threads = 3}, image, gradients[some]);
  }
  CHECK(all_columns(gradients[1]) == all_columns(gradients[0]));
  const std::vector<float> all = all_columns(gradients[0]);
  CHECK(std::any_of(all.begin(), all.end(), [](float g) { return g != 0; }));
}

TEST_CASE("render: the tile of a pixel is that of the whole picture, others are skipped") {
  const GaussianCloud cloud = test::random_cloud(2000, 5);
  const Camera camera = test::camera_at(6);
  std::vector<std::uint8_t> wanted(std::size_t(camera.width_px) * std::size_t(camera.height_px), 0);
  wanted[std::size_t(5 * camera.width_px + kTilePx + 4)] = 1;
  const TileFlags tiles = tiles_with(wanted, camera.width_px, camera.height_px);
  CHECK(std::accumulate(tiles.begin(), tiles.end(), 0) == 1);
  CHECK(tiles[1] == 1);
  RenderRequest request;
  const ImageF whole = render({.threads = 2}, cloud, camera, {}, request).colour;
  request.tiles = tiles.data();
  const ImageF part = render({.threads = 2}, cloud, camera, {}, request).colour;
  int skipped = 0;
  for (int y = 0; y < camera.height_px; ++y)
    for (int x = 0; x < camera.width_px; ++x) {
      const bool differs = part.at(x, y, 0) != whole.at(x, y, 0);
      if (y < kTilePx && x / kTilePx == 1) CHECK_FALSE(differs);
      skipped += differs;
    }
  CHECK(skipped > kTilePixels);
}

}  // namespace ngs
