#include "ngs/ops/splat/cached/cached_view.h"

#include <doctest/doctest.h>

#include "ngs/ops/splat/evidence.h"
#include "support/random_splats.h"

namespace ngs {
namespace {

/// A model and its camera; `prepared`: with a prepared cloud in the options.
struct Case {
  explicit Case(bool prepared, int threads = 2) {
    exec.threads = threads;
    if (prepared) options = prepared_for(exec, options, cloud);
  }
  Exec exec;
  GaussianCloud cloud = test::random_cloud(900, 7);
  Camera camera = test::camera_at(4);
  SplatOptions options;
};

PixelMask mask_of(const Camera& camera, const auto& is_object) {
  PixelMask mask;
  for (int y = 0; y < camera.height_px; ++y)
    for (int x = 0; x < camera.width_px; ++x) mask.push_back(is_object(x, y));
  return mask;
}

/// view_sums(), expanded to a row for every Gaussian of the cached view.
ViewSums sums_of(const Case& c, const PixelMask& mask, const std::vector<std::uint32_t>& rows) {
  const ViewSums sums = view_sums(c.exec, c.cloud, {c.camera, known_view(c.camera, mask)}, c.options);
  ViewSums all{1, false, {}, {}};
  std::size_t next = 0;
  for (const std::uint32_t row : rows) {
    double sum[2] = {};
    if (next < sums.size() && sums.row[next] == row) {
      sum[0] = sums.weight(next);
      sum[1] = sums.object_weight(next, 0);
      ++next;
    }
    all.add(row, sum);
  }
  CHECK(next == sums.size());
  return all;
}

}  // namespace

TEST_CASE("cached view: renders are bit-identical to render(), whatever was rendered before") {
  for (const bool prepared : {false, true}) {
    const Case c(prepared);
    CachedView cached(c.exec, c.cloud, c.camera, c.options);
    std::vector<float> label(2 * std::size_t(c.cloud.size()));
    for (std::size_t i = 0; i < label.size(); ++i) label[i] = float(i % 7) / 6;
    RenderRequest colour, labels, both, depth;
    colour.background = both.background = {0.2f, 0.4f, 0.8f};
    labels.colour = false;
    labels.label = both.label = {label.data(), c.cloud.size(), 2};
    depth.depth = true;
    for (const RenderRequest* request : {&colour, &labels, &both, &depth, &colour}) {
      const RenderedView wanted = render(c.exec, c.cloud, c.camera, c.options, *request);
      const RenderedView drawn = cached.render(c.exec, *request);
      CHECK(drawn.width_px == wanted.width_px);
      CHECK(drawn.colour.data == wanted.colour.data);
      CHECK(drawn.label.data == wanted.label.data);
      CHECK(drawn.depth.data == wanted.depth.data);
      CHECK(drawn.alpha.data == wanted.alpha.data);
    }
  }
}

TEST_CASE("cached view: the sums over a mask are bit-identical to view_sums(), for masks in any sequence") {
  for (const int threads : {1, 3}) {
    const Case c(true, threads);
    CachedView cached(c.exec, c.cloud, c.camera, c.options);
    REQUIRE(cached.rows().size() > 100);
    const auto left = [](int x, int) { return x < 61; };
    const auto masks = {mask_of(c.camera, left),
                        mask_of(c.camera, [&](int x, int y) { return left(x, y) || (x == 149 && y == 89); }),
                        mask_of(c.camera, [&](int x, int y) { return left(x, y) && y > 40; }),
                        mask_of(c.camera, [](int, int) { return false; }),
                        mask_of(c.camera, [](int, int) { return true; }),
                        mask_of(c.camera, left)};
    std::vector<double> before;
    std::size_t differing = 0;
    for (const PixelMask& mask : masks) {
      const ViewSums wanted = sums_of(c, mask, cached.rows()), &found = cached.weigh(c.exec, mask);
      CHECK(found.row == wanted.row);
      CHECK(found.sum == wanted.sum);
      differing += found.sum != before;
      before = found.sum;
    }
    CHECK(differing == masks.size());
  }
}

TEST_CASE("cached view: without visible Gaussians it has no rows and renders nothing") {
  Case c(true);
  c.camera.translation.z = -50;
  CachedView nothing(c.exec, c.cloud, c.camera, c.options);
  CHECK(nothing.rows().empty());
  CHECK(nothing.weigh(c.exec, mask_of(c.camera, [](int, int) { return true; })).sum.empty());
  CHECK(nothing.render(c.exec, RenderRequest()).alpha.data == std::vector<float>(150 * 90));
}

}  // namespace ngs
