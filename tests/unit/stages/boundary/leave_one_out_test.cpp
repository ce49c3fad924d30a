// ngs/stages/boundary/leave_one_out.h: what the others say is the evidence of the others, whether it was kept or not.
#include "ngs/stages/boundary/leave_one_out.h"

#include <doctest/doctest.h>

#include "ngs/core/rng.h"

namespace ngs {
namespace {

constexpr std::int64_t kGaussians = 5;
constexpr int kObjects = 2;

/// Gaussian 4 is seen by view 1 alone.
ViewSums gather(std::size_t view) {
  ViewSums sums{kObjects, {}, {}};
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

constexpr std::size_t kViews[] = {0, 1, 3};

}  // namespace

TEST_CASE("leaving a view out gives the evidence of the others, whether it is kept or gathered again") {
  for (const std::size_t kept : {std::size_t(0), std::size_t(200), std::size_t(1) << 20}) {
    CAPTURE(kept);
    const Exec exec;
    LeaveOneOut views(exec, kGaussians, kObjects, gather, kept);
    for (const std::size_t v : kViews) views.add(v);
    for (std::size_t left_out = 0; left_out < 4; ++left_out) {
      Evidence others(kGaussians, kObjects);
      for (const std::size_t v : kViews)
        if (v != left_out) {
          const ViewSums sums = gather(v);
          for (std::size_t row = 0; row < sums.size(); ++row) others.add(sums.row[row], sums.at(row));
        }
      const LeaveOneOut::Rest rest = views.without(left_out);
      LeaveOneOut::Shares shares = views.all();
      std::vector<double> own(5, 0.0);
      for (std::size_t v = 0; v < rest.row.size(); ++v) {
        const std::size_t i = rest.row[v];
        own[i] = rest.own[v], shares.seen[i] = rest.others.seen[v];
        std::copy_n(&rest.others.share[2 * v], 2, &shares.share[2 * i]);
      }
      for (std::size_t i = 0; i < 5; ++i) {
        CHECK(int(shares.seen[i]) == (i == 4 && left_out == 1 ? 0 : 1));
        const bool sees = left_out != 2 && (i < 4 || left_out == 1);
        CHECK(own[i] == (sees ? gather(left_out).weight(i) : 0));
        for (std::size_t k = 2 * i; k < 2 * i + 2; ++k)
          CHECK(double(shares.share[k]) ==
                doctest::Approx(shares.seen[i] ? others.object_weight.value(k) / others.weight.value(i) : 0));
      }
    }
  }
}

TEST_CASE("a view that was removed leaves the bits of the others, and may be added again") {
  for (const std::size_t kept : {std::size_t(0), std::size_t(200), std::size_t(1) << 20}) {
    CAPTURE(kept);
    LeaveOneOut removed({}, kGaussians, kObjects, gather, kept), never({}, kGaussians, kObjects, gather, kept);
    for (const std::size_t v : kViews) removed.add(v);
    removed.remove(1), removed.remove(2);  // the second was not there
    never.add(0), never.add(3);
    const auto same = [&] {
      for (std::size_t left_out = 0; left_out < 4; ++left_out) {
        const LeaveOneOut::Rest a = removed.without(left_out), b = never.without(left_out);
        CHECK(a.row == b.row);
        CHECK(a.others.seen == b.others.seen);
        CHECK(a.others.share == b.others.share);
        CHECK(a.own == b.own);
      }
    };
    same();
    CHECK(removed.all().share == never.all().share);
    removed.add(1), never.add(1);
    same();
  }
}

}  // namespace ngs
