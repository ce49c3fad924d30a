#include "ngs/scene/evidence.h"

#include <doctest/doctest.h>

#include <array>

#include "support/same_evidence.h"

namespace ngs {
namespace {

/// A view of Gaussians 0 and 2: W, then W1 of two objects.
ViewSums view_of(const std::array<double, 3>& first, const std::array<double, 3>& last) {
  ViewSums view{2, false, {}, {}};
  view.add(0, first.data()), view.add(2, last.data());
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
  sums.add(one), sums.add(other);
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
  whole.add(view), by_row.add(2, row);
  CHECK(test::same_evidence(whole, by_row));
  CHECK((whole.views[2] == 1 && whole.pixels[2] == 9));
  CHECK(test::object_pixels(whole, 2, 0) == 2);
  CHECK_THROWS(whole.add(view.weights()));
}

}  // namespace ngs
