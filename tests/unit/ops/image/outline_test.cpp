#include "ngs/ops/image/outline.h"

#include <doctest/doctest.h>

#include "support/mask_zoo.h"

namespace ngs {
namespace {

using test::Mask;
using test::MaskKind;

std::int64_t enclosed_area(const std::vector<Loop>& loops) {
  std::int64_t twice = 0;
  for (const Loop& loop : loops)
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const GridPoint a = loop[i], b = loop[(i + 1) % loop.size()];
      twice += std::int64_t(a.x) * b.y - std::int64_t(b.x) * a.y;
    }
  return twice / 2;
}

TEST_CASE("the outline of one pixel is its square") {
  Mask mask(3, 2);
  mask.at(1, 1) = 1;
  const auto loops = outlines(mask.plane());
  REQUIRE(loops.size() == 1);
  CHECK(loops[0] == Loop{{2, 1}, {2, 2}, {1, 2}, {1, 1}});
}

TEST_CASE("empty masks have no outline") {
  CHECK(outlines(Mask(4, 4).plane()).empty());
  CHECK(outlines(Mask(0, 0).plane()).empty());
}

TEST_CASE("a ring has an outer and an inner loop") {
  Mask ring(3, 3);
  for (auto& pixel : ring.data) pixel = 1;
  ring.at(1, 1) = 0;
  const auto loops = outlines(ring.plane());
  CHECK(loops.size() == 2);
  CHECK(enclosed_area(loops) == 8);
}

TEST_CASE("outlines enclose exactly the object, for every kind of mask") {
  for (int n = 0; n < 300; ++n) {
    CAPTURE(n);
    const auto side = [&](std::uint64_t i) {
      return 1 + int(rng_bits(3, RngStream::kTest, 2 * std::uint64_t(n) + i) % 30);
    };
    const Mask mask = test::zoo_mask(MaskKind(n % int(MaskKind::kCount)), side(0), side(1), std::uint64_t(n));
    std::int64_t pixels = 0, edges = 0, traced = 0;
    const auto on = [&](int x, int y) {
      return x >= 0 && y >= 0 && x < mask.width_px && y < mask.height_px && mask.at(x, y) != 0;
    };
    for (int y = 0; y < mask.height_px; ++y)
      for (int x = 0; x < mask.width_px; ++x) {
        pixels += on(x, y);
        if (on(x, y)) edges += !on(x - 1, y) + !on(x + 1, y) + !on(x, y - 1) + !on(x, y + 1);
      }
    const auto loops = outlines(mask.plane());
    for (const Loop& loop : loops)
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const GridPoint a = loop[i], b = loop[(i + 1) % loop.size()];
        REQUIRE((a.x == b.x) != (a.y == b.y));
        traced += std::abs(a.x - b.x) + std::abs(a.y - b.y);
      }
    CHECK(enclosed_area(loops) == pixels);
    CHECK(traced == edges);  // each edge between object and complement once
  }
}

}  // namespace
}  // namespace ngs
