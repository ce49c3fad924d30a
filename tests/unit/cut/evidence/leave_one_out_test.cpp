#include "ngs/cut/evidence/leave_one_out.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "ngs/core/rng.h"
#include "ngs/cut/evidence/method_labels.h"
#include "ngs/problem/region.h"
#include "support/joint_case.h"

namespace ngs {
namespace {

constexpr std::int64_t kGaussians = 5;
constexpr int kObjects = 2;

/// Gaussian 4 is visible in view 1 only.
ViewSums gather(std::size_t view) {
  ViewSums sums{kObjects, true, {}, {}};
  for (std::size_t i = 0; i < 5; ++i) {
    if (i == 4 && view != 1) continue;
    const double weight = 1 + rng_uniform(view, RngStream::kTest, i);
    sums.row.push_back(std::uint32_t(i));
    sums.sum.insert(sums.sum.end(), {weight, 1});
    for (std::size_t k = 0; k < 2; ++k)
      sums.sum.insert(sums.sum.end(), {weight * rng_uniform(view, RngStream::kTest, 100 + 2 * i + k), 0});
  }
  return sums;
}

PackedSums gather_packed(std::size_t view) {
  const ViewSums sums = gather(view);
  PackedSums packed(kObjects, 2);
  for (std::size_t row = 0; row < sums.size(); ++row) packed.add(row < 2 ? 0 : 1, sums.row[row], sums.at(row));
  return packed;
}

constexpr std::size_t kMaskedViews[] = {0, 1, 3};

/// [5], [5, 2], [5] what the others and what all say; weight in the view that was left out, of what it shows.
struct Said {
  std::vector<int> seen = std::vector<int>(5, -1);
  std::vector<float> share = std::vector<float>(10, -1.f);
  std::vector<double> own = std::vector<double>(5, 0.0);

  void set(std::size_t i, const LeaveOneOut::Shares& shares) {
    seen[i] = shares.seen;
    std::copy_n(shares.share, 2, &share[2 * i]);
  }
  static Said by_all(const LeaveOneOut& views) {
    Said said;
    views.for_all([&](std::size_t i, const LeaveOneOut::Shares& all) { said.set(i, all); });
    return said;
  }
  static Said by_others(LeaveOneOut& views, std::size_t left_out) {
    Said said = by_all(views);
    if (const auto own = views.weights_of(left_out))
      views.for_others_in(*own, [&](std::size_t i, const LeaveOneOut::Shares& others, double weight) {
        said.set(i, others);
        said.own[i] = weight;
      });
    return said;
  }
  bool operator==(const Said&) const = default;
};

}  // namespace

TEST_CASE("sums without one view equal the evidence of the others, whether weights are cached or gathered again") {
  for (const std::size_t kept : {std::size_t(0), std::size_t(200), std::size_t(1) << 20}) {
    CAPTURE(kept);
    const Exec exec;
    LeaveOneOut views(exec, kGaussians, kObjects, gather_packed, kept);
    for (const std::size_t v : kMaskedViews) views.add(v);
    for (std::size_t left_out = 0; left_out < 4; ++left_out) {
      Evidence others(kGaussians, kObjects);
      for (const std::size_t v : kMaskedViews)
        if (v != left_out) {
          const ViewSums sums = gather(v);
          for (std::size_t row = 0; row < sums.size(); ++row) others.add(sums.row[row], sums.at(row));
        }
      const Said said = Said::by_others(views, left_out);
      for (std::size_t i = 0; i < 5; ++i) {
        CHECK(said.seen[i] == (i == 4 && left_out == 1 ? 0 : 1));
        const bool sees = left_out != 2 && (i < 4 || left_out == 1);
        CHECK(said.own[i] == (sees ? gather(left_out).weight(i) : 0));
        for (std::size_t k = 0; k < 2; ++k)
          CHECK(double(said.share[2 * i + k]) == doctest::Approx(said.seen[i] ? others.prob(i, k) : 0));
      }
    }
  }
}

TEST_CASE("removing a view leaves bit-identical sums of the others, and it can be added again") {
  for (const std::size_t kept : {std::size_t(0), std::size_t(200), std::size_t(1) << 20}) {
    CAPTURE(kept);
    LeaveOneOut removed({}, kGaussians, kObjects, gather_packed, kept),
        never({}, kGaussians, kObjects, gather_packed, kept);
    for (const std::size_t v : kMaskedViews) removed.add(v);
    removed.remove(1);
    removed.remove(2);  // the second has no effect
    never.add(0);
    never.add(3);
    const auto same = [&] {
      for (std::size_t left_out = 0; left_out < 4; ++left_out)
        CHECK(Said::by_others(removed, left_out) == Said::by_others(never, left_out));
    };
    same();
    CHECK(Said::by_all(removed) == Said::by_all(never));
    removed.add(1);
    never.add(1);
    same();
  }
}

TEST_CASE("sums started from labels and their weight equal those after adding all views") {
  for (const std::size_t kept : {std::size_t(0), std::size_t(200), std::size_t(1) << 20}) {
    CAPTURE(kept);
    LeaveOneOut added({}, kGaussians, kObjects, gather_packed, kept),
        begun({}, kGaussians, kObjects, gather_packed, kept);
    for (const std::size_t v : kMaskedViews) added.add(v);
    std::vector<LabelColumns> labels(kObjects);
    std::vector<float> weight;
    for (std::size_t i = 0; i < 5; ++i) {
      weight.push_back(float(added.sums().weight.value(i)));
      for (std::size_t k = 0; k < 2; ++k) labels[k].prob.push_back(float(added.sums().prob(i, k)));
    }
    begun.start(labels, weight, {0, 1, 3});
    const auto close = [&] {
      for (std::size_t left_out = 0; left_out < 4; ++left_out) {
        CAPTURE(left_out);
        const Said a = Said::by_others(added, left_out), b = Said::by_others(begun, left_out);
        CHECK(a.seen == b.seen);
        CHECK(a.own == b.own);
        for (std::size_t s = 0; s < a.share.size(); ++s) CHECK(a.share[s] == doctest::Approx(b.share[s]).epsilon(1e-5));
      }
    };
    close();
    added.remove(3);
    begun.remove(3);
    close();
    // Gaussian 4 is visible in no other view: rounding must not make its weight negative.
    added.remove(1);
    begun.remove(1);
    CHECK(begun.sums().weight.value(4) >= 0);
    CHECK(begun.sums().weight.value(4) < 1e-6);
    CHECK(begun.sums().object_weight(4, 0) < 1e-6);
    begun.add(1);
    added.add(1);
    close();
  }
}

namespace {

struct Recomputed {
  std::unique_ptr<test::JointCase> base = test::joint_case();
  Problem input;

  explicit Recomputed(const BoundaryRule& rule) : input(base->input()) {
    input.rule = rule;
    input.labels = label_gaussians(
        rule,
        accumulate_evidence({}, test::Quiet(), {base->model, base->scene, input.views, input.splat, input.load_masks}));
  }
  LabelColumns labels() const { return recompute_labels({}, test::Quiet(), input, base->model)[0]; }
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
    const Evidence rest = accumulate_evidence(
        {}, test::Quiet(), {c.base->model, c.base->scene, {0, 1, 2}, c.input.splat, c.input.load_masks});
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
