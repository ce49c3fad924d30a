#include "ngs/cut/methods/method_bce.h"

#include <doctest/doctest.h>

#include "ngs/cut/evidence/method_labels.h"
#include "support/method_case.h"

namespace ngs {

TEST_CASE("bce improves on the closed form it starts from and certifies the result") {
  const test::MethodCase c = test::method_case(70, 200, 4);
  Monitor monitor;
  const BceResult r = solve_bce({}, monitor, {}, c.input());
  CHECK(r.method.converged);
  CHECK(r.method.figures.at("relative_gap") <= 1e-3);
  CHECK(r.trace[0].back().certified);
  CHECK(r.trace[0].back().loss < 0.95 * r.trace[0].front().loss);
  const LabelColumns& labels = r.method.labels[0];
  for (std::size_t i = 0; i < 200; ++i)
    if (labels.views[i] > 0) CHECK(labels.label[i] == labels.prob[i]);
}

TEST_CASE("bce does not change Gaussians that were fixed by hand or are visible in no view") {
  const test::MethodCase c = test::method_case(71, 80, 3);
  Monitor monitor;
  Problem input = c.input();
  std::vector<LabelColumns> labels = closed_form_labels({}, monitor, input);
  input.fixed.assign(80, 0.f);
  for (std::size_t i = 0; i < 80; i += 2) input.fixed[i] = 1.f, labels[0].label[i] = float(i % 4 == 0);
  input.labels = std::move(labels);
  const Solution r = solve_bce({}, monitor, {}, input).method;
  int unseen = 0;
  for (std::size_t i = 0; i < 80; ++i) {
    if (i % 2 == 0) CHECK(r.labels[0].label[i] == float(i % 4 == 0));
    if (r.labels[0].views[i] > 0) continue;
    ++unseen;
    CHECK(r.labels[0].prob[i] == input.labels[0].prob[i]);
    CHECK(r.labels[0].label[i] == input.labels[0].label[i]);
  }
  CHECK(unseen > 0);
}

TEST_CASE("bce assigns a Gaussian in the masks of two objects to the one with the larger soft label") {
  test::MethodCase c = test::method_case(72, 150, 3, 2);
  for (ViewMasks& m : c.masks) m.target[1] = m.target[0];  // both objects have the same mask
  Monitor monitor;
  const Solution r = solve_bce({}, monitor, {}, c.input()).method;
  double shared = 0;
  for (std::size_t i = 0; i < 150; ++i) {
    CHECK(r.labels[0].label[i] + r.labels[1].label[i] <= 1.f);
    shared += double(r.labels[0].prob[i] * r.labels[1].prob[i]);
  }
  CHECK(shared > 10);
  CHECK(r.figures.count("gap_object1") == 1);
}

}  // namespace ngs
