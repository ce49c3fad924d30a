#include "ngs/scene/rle_masks.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace ngs {

TEST_CASE(
    "run-length encoded masks decode bit for bit: contours, signed zeros, NaN, planes of one value and empty ones") {
  ViewMasks masks{7, 3, {}, {1, 0, 1}, true};
  masks.target.push_back({0, 0, 1, 1, 0.25f, 0, 0, 1, 1, 1, 0.5f, 0.5f, 0.75f, 0, 0, 0, 0, 0, 0, 0, 1});
  masks.target.push_back({0.f, -0.f, 0.f, NAN, NAN, -NAN, std::nextafter(1.f, 0.f), 1.f});
  masks.target.emplace_back(21, 1.f);
  masks.target.emplace_back();
  const ViewMasks back = RleMasks(masks).unpacked();
  CHECK((back.width_px == 7 && back.height_px == 3 && back.available));
  CHECK(back.known == masks.known);
  REQUIRE(back.target.size() == masks.target.size());
  for (std::size_t k = 0; k < masks.target.size(); ++k) {
    REQUIRE(back.target[k].size() == masks.target[k].size());
    for (std::size_t i = 0; i < masks.target[k].size(); ++i)
      CHECK(std::bit_cast<std::uint32_t>(back.target[k][i]) == std::bit_cast<std::uint32_t>(masks.target[k][i]));
  }
  CHECK(RleMasks(masks).available());
  CHECK_FALSE(RleMasks().available());
  CHECK(RleMasks().unpacked().target.empty());
}

TEST_CASE("run-length encoded masks take memory in proportion to their contours, and never more than the planes") {
  ViewMasks binary{64, 64, {}, {}, true}, soft = binary;
  binary.target.emplace_back(64 * 64, 0.f);
  std::fill_n(binary.target[0].begin() + 1000, 2000, 1.f);
  soft.target.emplace_back(64 * 64);
  for (std::size_t i = 0; i < soft.target[0].size(); ++i) soft.target[0][i] = float(i % 255) / 255;
  soft.known.assign(64 * 64, 1);
  CHECK(RleMasks(binary).bytes() <= 3 * 8);
  CHECK(RleMasks(soft).bytes() == 64 * 64 * (sizeof(float) + 1));
  CHECK(RleMasks(soft).unpacked().target == soft.target);
}

}  // namespace ngs
