#include "ngs/scene/evidence.h"

#include <doctest/doctest.h>

#include <array>
#include <utility>

#include "ngs/scene/view_sums.h"
#include "support/same_evidence.h"

namespace ngs {
namespace {

/// A view of Gaussians 0 and 2: W, then W1 of two objects.
ViewSums view_of(const std::array<double, 3>& first, const std::array<double, 3>& last) {
  ViewSums view{2, false, {}, {}};
  view.add(0, first.data());
  view.add(2, last.data());
  return view;
}

}  // namespace

TEST_CASE("adding views and removing them in any order leaves exactly 0, from the largest to the smallest weight") {
  std::vector<ViewSums> views;
  for (const double w : {0.1, 0.7, 1e-9, 3e5}) views.push_back(view_of({w, w / 7, 0}, {w / 3, 0, w / 3}));
  WeightSums<> sums(3, 2);
  for (const ViewSums& view : views) sums.add(view);
  CHECK(sums.weight.value(0) == doctest::Approx(300000.8));
  CHECK(sums.object_weight(0, 0) == doctest::Approx(300000.8 / 7));
  CHECK(sums.prob(0, 0) == doctest::Approx(1.0 / 7));
  CHECK(sums.prob(0, 1) == 0);
  CHECK(sums.prob(2, 1) == 1);
  CHECK(sums.prob(1, 0) == 0);  // in no view
  for (const std::size_t v : {2, 0, 3, 1}) sums.remove(views[v]);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(sums.weight.at(i) == ExactSum());
    for (std::size_t k = 0; k < 2; ++k) CHECK(sums.object_weight(i, k) == 0);
    CHECK(sums.prob(i, 0) == 0);
  }
}

TEST_CASE("probabilities without one view are those of the other views") {
  const ViewSums one = view_of({2, 1, 0.5}, {4, 4, 0}), other = view_of({6, 0, 3}, {1e-4, 0, 1e-4});
  WeightSums<> sums(3, 2);
  sums.add(one);
  sums.add(other);
  float probs[2] = {-1, -1};
  CHECK(sums.probs(0, probs));
  CHECK(probs[0] == doctest::Approx(1.0 / 8));
  CHECK(probs[1] == doctest::Approx(3.5 / 8));
  CHECK(sums.probs_without(one.at(0), 0, probs));
  CHECK(probs[0] == 0);
  CHECK(probs[1] == doctest::Approx(0.5));
  CHECK(!sums.probs_without(one.at(1), 2, probs));  // less than 1/1000 of the weight remains
  CHECK((probs[0] == 0 && probs[1] == 0));
  CHECK(!sums.probs(1, probs));
}

TEST_CASE("the heaviest object owns a Gaussian if it exceeds the background") {
  WeightSums<> sums(3, 2);
  sums.add(view_of({10, 3, 4}, {10, 3, 3}));
  CHECK(sums.heaviest_object(0) == 1);
  CHECK(sums.heaviest_object(1) == -1);
  CHECK(sums.heaviest_object(2) == -1);
}

TEST_CASE("the evidence of a view is that of its rows one by one") {
  const double row[] = {4, 9, 1, 2};
  ViewSums view{1, true, {}, {}};
  view.add(2, row);
  Evidence whole(3, 1), by_row(3, 1);
  whole.add(view);
  by_row.add(2, row);
  CHECK(test::same_evidence(whole, by_row));
  CHECK((whole.views[2] == 1 && whole.pixels[2] == 9));
  CHECK(test::object_pixels(whole, 2, 0) == 2);
  CHECK_THROWS(whole.add(view.weights()));
}

TEST_CASE("the weights of a view, and those inside a mask, list the rows where they are positive") {
  const double two[] = {4, 9, 1, 2, 0, 0}, hidden[] = {0, 0, 0, 0, 0, 0}, outside[] = {0.5, 1, 0, 0, 0.5, 1};
  ViewSums sums{2, true, {}, {}};
  sums.add(3, two);
  sums.add(5, hidden);
  sums.add(8, outside);
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
