// Labels recomputed for a changed model or changed masks follow the rule of the given labels.
#include "ngs/cut/evidence/method_labels.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "ngs/problem/region.h"
#include "support/joint_case.h"

namespace ngs {
namespace {

struct Recomputed {
  std::unique_ptr<test::JointCase> base = test::joint_case();
  Problem input;

  explicit Recomputed(const BoundaryRule& rule) : input(base->input()) {
    Monitor monitor;
    input.rule = rule;
    input.labels = label_gaussians(
        rule, accumulate_evidence({}, monitor, {base->model, base->scene, input.views, input.splat, input.load_masks}));
  }
  LabelColumns labels() const {
    Monitor monitor;
    return recompute_labels({}, monitor, input, base->model)[0];
  }
};

}  // namespace

TEST_CASE("recomputed labels equal the given ones if nothing changed, for every criterion and tau") {
  for (const NamedValue<Criterion>& criterion : kCriterionChoices)
    for (const double tau : {0.05, 0.3}) {
      CAPTURE(criterion.name);
      CAPTURE(tau);
      const Recomputed c({.tau = tau, .criterion = criterion.value});
      const LabelColumns& given = c.input.labels[0];
      const LabelColumns found = c.labels();
      CHECK(std::count(given.boundary.begin(), given.boundary.end(), 1.f) > 0);
      CHECK(found.boundary == given.boundary);
      CHECK(found.variance == given.variance);
      CHECK(found.prob == given.prob);
    }
}

TEST_CASE("recomputed labels keep the criterion if a mask is removed") {
  for (const NamedValue<Criterion>& criterion : kCriterionChoices) {
    CAPTURE(criterion.name);
    Recomputed c({.tau = 0.1, .criterion = criterion.value});
    c.base->masks[3].available = false;
    const LabelColumns found = c.labels();
    Monitor monitor;
    const Evidence rest =
        accumulate_evidence({}, monitor, {c.base->model, c.base->scene, {0, 1, 2}, c.input.splat, c.input.load_masks});
    const LabelColumns all = label_gaussians(c.input.rule, rest)[0];
    const std::vector<std::uint8_t> before = region_of(c.input.labels), after = region_of({found});
    int compared = 0;
    for (std::size_t i = 0; i < all.variance.size(); ++i) {
      const bool concerned = before[i] || after[i];
      CHECK(found.variance[i] == (concerned ? all : c.input.labels[0]).variance[i]);
      CHECK(found.boundary[i] == (concerned ? all : c.input.labels[0]).boundary[i]);
      compared += concerned;
    }
    CHECK(compared > 20);
  }
}

}  // namespace ngs
