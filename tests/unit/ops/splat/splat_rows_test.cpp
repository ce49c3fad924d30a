#include "ngs/ops/splat/splat_rows.h"

#include <doctest/doctest.h>

#include <cmath>

#include "support/random.h"
#include "support/splat_record.h"

namespace ngs {
namespace {

/// A tile's list of `kAhead` ellipses of any size, with axis ratios up to 100, whose border passes near the tile.
struct List {
  std::vector<SplatRecord<float>> record;
  std::vector<std::uint32_t> index;

  explicit List(test::Random& random) {
    for (std::uint32_t i = 0; i < kAhead; ++i) {
      const double angle = random.uniform(0, 6.283), along = random.uniform(0, 6.283),
                   major = std::pow(10.0, random.uniform(-0.3, 5.5)),
                   minor = std::max(0.5, major * std::pow(10.0, random.uniform(-2, 0)));
      const double c = std::cos(angle), s = std::sin(angle);
      const double xx = c * c * major * major + s * s * minor * minor,
                   yy = s * s * major * major + c * c * minor * minor, xy = c * s * (major * major - minor * minor);
      const auto opacity = float(random.uniform(0.005, 1));
      const double radius = std::sqrt(2 * std::log(255 * opacity));
      // A point of the border; it is placed inside the tile.
      const double px = c * major * radius * std::cos(along) - s * minor * radius * std::sin(along),
                   py = s * major * radius * std::cos(along) + c * minor * radius * std::sin(along);
      const double x = random.uniform(0, 16) - px, y = random.uniform(0, 16) - py;
      record.push_back(test::splat_record(x, y, xx, xy, yy, opacity));
      index.push_back(i);
    }
  }
  TileWork<float> work() const {
    return {{0, 0, kTilePx, kTilePx}, record.data(), index.data(), index.data(), kAhead, 1e-4f};
  }
};

/// The same records in double.
std::vector<SplatRecord<double>> wide(const std::vector<SplatRecord<float>>& record) {
  std::vector<SplatRecord<double>> out;
  for (const SplatRecord<float>& g : record)
    out.push_back({g.mean_x,
                   g.mean_y,
                   {g.form.along_u, g.form.along_v, g.form.across},
                   g.log2_opacity,
                   g.max_mahalanobis2,
                   g.inv_det,
                   g.half_width,
                   g.half_height,
                   g.bottom_x,
                   g.inv_c});
  return out;
}

struct Count {
  int visited = 0, reached = 0;
  int lost = 0;  // reached and visited in double, but not in float: lost to rounding
};

/// Counts rows per band that are visited, and those with a contributing pixel.
template <class L>
void count_rows(const List& list, Count& count) {
  constexpr int kBandPx = LaneTraits<L>::kLanes < 8 ? 1 : 8;
  const std::vector<SplatRecord<double>> record = wide(list.record);
  RowsAhead<L> rows;
  RowsAhead<double> exact;
  rows.find(list.work(), 0);
  exact.find({list.work().frame, record.data(), list.index.data(), list.index.data(), kAhead, 1e-4}, 0);
  for (std::uint32_t k = 0; k < kAhead; ++k)
    for (int y = 0; y < kTilePx; ++y)
      for (int band = 0; band < kTilePx / kBandPx; ++band) {
        const bool visits = (rows.rows(k, band) >> y & 1) != 0;
        bool reaches = false, should = false;
        for (int x = band * kBandPx; x < (band + 1) * kBandPx; ++x) {
          PixelTraversal<float> traversal{1.f, true};
          float before;
          reaches |=
              traversal.pass(tile_gaussian(list.record[k], list.work().frame), float(x), float(y), 1e-4f, before) > 0;
          should |= (exact.rows(k, x) >> y & 1) != 0;
        }
        count.visited += visits;
        count.reached += reaches;
        count.lost += reaches && should && !visits;
      }
}

/// Whether the Gaussian contributes to a pixel of the tile.
bool reaches_tile(const SplatRecord<float>& g, int tx, int ty) {
  const TileFrame frame{tx * kTilePx, ty * kTilePx, (tx + 1) * kTilePx, (ty + 1) * kTilePx};
  for (int y = 0; y < kTilePx; ++y)
    for (int x = 0; x < kTilePx; ++x) {
      PixelTraversal<float> traversal{1.f, true};
      float before;
      if (traversal.pass(tile_gaussian(g, frame), float(x), float(y), 1e-4f, before) > 0) return true;
    }
  return false;
}

bool contains(const TileSpan& span, int tx) { return tx >= span.first && tx < span.end; }

constexpr int kTiles = 5, kMiddlePx = kTiles / 2 * kTilePx;

/// Counts the tiles of an image of kTiles x kTiles tiles.
void count_tiles(const SplatRecord<float>& g, Count& count) {
  const TileRect all{0, kTiles, 0, kTiles};
  const SplatRecord<double> exact = wide({g})[0];
  for (int ty = 0; ty < kTiles; ++ty) {
    const TileSpan listed = tile_span(g, all, ty), should = tile_span(exact, all, ty);
    for (int tx = 0; tx < kTiles; ++tx) {
      count.visited += contains(listed, tx);
      count.reached += contains(should, tx);
      count.lost += contains(should, tx) && !contains(listed, tx) && reaches_tile(g, tx, ty);
    }
  }
}

}  // namespace

TEST_CASE("tile_span: rounding drops no tile, and adds less than 1 % of tiles") {
  test::Random random(2);
  Count count;
  for (int i = 0; i < 30000; ++i) {
    const List list(random);
    for (SplatRecord<float> g : list.record) {
      g.mean_x += kMiddlePx;
      g.mean_y += kMiddlePx;  // the border passes near the middle tile
      count_tiles(g, count);
    }
  }
  MESSAGE("listed ", count.visited, ", in double ", count.reached, ", lost ", count.lost);
  CHECK(count.reached > 5000000);
  CHECK(count.lost == 0);
  CHECK(count.visited < 1.01 * count.reached);
}

TEST_CASE(
    "rows ahead: for ellipses from half a pixel to 300000 px rounding drops no row, and adds less than 2 % of rows") {
  test::Random random(1);
  Count packs, lanes;
  for (int i = 0; i < 2000; ++i) {
    const List list(random);
    count_rows<PackF>(list, packs);
    count_rows<float>(list, lanes);
  }
  for (const Count& count : {packs, lanes}) {
    MESSAGE("visited ", count.visited, ", reached ", count.reached, ", lost ", count.lost);
    CHECK(count.reached > 1000000);
    CHECK(count.lost == 0);
    CHECK(count.visited < 1.02 * count.reached);
  }
}

}  // namespace ngs
