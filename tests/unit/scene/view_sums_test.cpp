#include "ngs/scene/view_sums.h"

#include <doctest/doctest.h>

#include <utility>

namespace ngs {

TEST_CASE("the weights of a view, and those inside a mask, list the rows where they are positive") {
  const double two[] = {4, 9, 1, 2, 0, 0}, hidden[] = {0, 0, 0, 0, 0, 0}, outside[] = {0.5, 1, 0, 0, 0.5, 1};
  ViewSums sums{2, true, {}, {}};
  sums.add(3, two), sums.add(5, hidden), sums.add(8, outside);
  const ViewSums all = sums.weights(), first = sums.weights_inside(0), second = sums.weights_inside(1);
  CHECK(all.row == std::vector<std::uint32_t>{3, 8});
  CHECK(all.sum == std::vector<double>{4, 0.5});
  CHECK(first.row == std::vector<std::uint32_t>{3});
  CHECK(first.weight(0) == 1);
  CHECK(second.row == std::vector<std::uint32_t>{8});
  CHECK(second.weights().sum == second.sum);
  CHECK(ViewSums().weights().size() == 0);
}

TEST_CASE("packed weights unpack bit-identically: of no object, of one, of several, floats or not") {
  constexpr std::size_t kMany = 300;  // objects: indices need more than one byte
  const double third = 1.0 / 3, large = 0x1p40 + 1;
  const std::vector<std::pair<std::uint32_t, std::vector<std::pair<std::size_t, double>>>> rows{
      {0, {}},           {1, {{299, third}}}, {130, {{0, 0.25}}}, {70000, {{2, third / 2}, {3, 0.5}, {200, 1e-30}}},
      {4000000000u, {}}, {129, {}},  // unsorted
      {4294967295u, {}}, {2, {{1, 0.5}}}};
  const double weight[] = {0.5, third, 0.25, large, 1e-42, 0.125, 0.25, 1.0};
  PackedSums packed(kMany, 3);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    std::vector<double> sum(2 + 2 * kMany, 0.0);
    sum[0] = weight[r];
    for (const auto& [k, w] : rows[r].second) sum[2 + 2 * k] = w;
    packed.add(1, rows[r].first, sum.data());
  }
  std::size_t row = 0;
  packed.for_each(1, [&](std::uint32_t gaussian, const double* got) {
    CAPTURE(row);
    REQUIRE(row < rows.size());
    std::vector<double> want(1 + kMany, 0.0);
    want[0] = weight[row];
    for (const auto& [k, w] : rows[row].second) want[1 + k] = w;
    CHECK(gaussian == rows[row].first);
    CHECK(std::vector<double>(got, got + 1 + kMany) == want);
    ++row;
  });
  CHECK(row == rows.size());
  for (const std::size_t part : {std::size_t(0), std::size_t(2)})
    packed.for_each(part, [](std::uint32_t, const double*) { FAIL("nothing was added"); });
  CHECK(packed.bytes() < 130);
}

}  // namespace ngs
