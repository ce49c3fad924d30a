#include <doctest/doctest.h>

#include "ngs/cut/methods/method_bce.h"
#include "ngs/cut/methods/method_cob.h"
#include "ngs/cut/methods/method_flash.h"
#include "ngs/cut/methods/method_released.h"
#include "ngs/cut/methods/method_sa3d.h"
#include "ngs/cut/methods/method_saga.h"
#include "support/method_case.h"

namespace ngs {
namespace {

using Run = Solution (*)(const Exec&, Monitor&, const Problem&);
struct NamedRun {
  const char* name;
  Run run;
  bool view_order_matters, row_order_matters;  // rows matter through random draws per row
  bool sums_exactly = false;                   // its probabilities are the same bits in any order
};

const NamedRun kRuns[] = {
    {"flash", [](const Exec& e, Monitor& m, const Problem& in) { return run_flash(e, m, {}, in); }, false, false, true},
    {"bce", [](const Exec& e, Monitor& m, const Problem& in) { return solve_bce(e, m, {}, in).method; }, false, false},
    {"cob", [](const Exec& e, Monitor& m, const Problem& in) { return run_cob(e, m, {}, in); }, true, true},
    {"released",
     [](const Exec& e, Monitor& m, const Problem& in) {
       ReleasedOptions short_run;
       short_run.cob.rounds = 1;
       return run_released(e, m, short_run, in);
     },
     true, true},
    {"saga",
     [](const Exec& e, Monitor& m, const Problem& in) {
       return run_saga(e, m, {.dims = 8, .steps = 12, .pixels = 64}, in);
     },
     true, true},
    {"sa3d", [](const Exec& e, Monitor& m, const Problem& in) { return run_sa3d(e, m, {}, in); }, true, false},
};

void check_equal(const Solution& a, const Solution& b) {
  REQUIRE(a.labels.size() == b.labels.size());
  CHECK(a.source_row == b.source_row);
  CHECK(a.cloud->position == b.cloud->position);
  CHECK(a.cloud->sh_dc == b.cloud->sh_dc);
  for (std::size_t k = 0; k < a.labels.size(); ++k) {
    CHECK(a.labels[k].label == b.labels[k].label);
    CHECK(a.labels[k].prob == b.labels[k].prob);
    CHECK(a.labels[k].views == b.labels[k].views);
  }
}

}  // namespace

TEST_CASE("a method's result does not depend on the number of threads") {
  const test::MethodCase c = test::method_case(11, 70, 4, 2);
  for (const NamedRun& method : kRuns) {
    CAPTURE(method.name);
    check_equal(method.run({.threads = 1}, test::Quiet(), c.input()),
                method.run({.threads = 3}, test::Quiet(), c.input()));
  }
}

TEST_CASE("a method that sums over views gives the same labels for any order of them") {
  const test::MethodCase c = test::method_case(12, 70, 4);
  for (const NamedRun& method : kRuns) {
    if (method.view_order_matters) continue;
    CAPTURE(method.name);
    Problem shuffled = c.input();
    shuffled.views = {2, 0, 3, 1};
    const Solution a = method.run({}, test::Quiet(), c.input()), b = method.run({}, test::Quiet(), shuffled);
    CHECK(a.labels[0].label == b.labels[0].label);
  }
}

TEST_CASE("permuting the Gaussians permutes the labels") {
  const test::MethodCase c = test::method_case(13, 70, 4);
  std::vector<std::size_t> order(70);
  for (std::size_t i = 0; i < 70; ++i) order[i] = (i * 37 + 11) % 70;
  test::MethodCase p = c;
  p.cloud = test::permuted(c.cloud, order);
  for (const NamedRun& method : kRuns) {
    if (method.row_order_matters) continue;
    CAPTURE(method.name);
    const Solution a = method.run({}, test::Quiet(), c.input()), b = method.run({}, test::Quiet(), p.input());
    const LabelColumns &got = b.labels[0], &want = a.labels[0];
    for (std::size_t i = 0; i < order.size(); ++i) {
      CHECK(got.label[i] == want.label[order[i]]);
      if (method.sums_exactly)
        CHECK((got.prob[i] == want.prob[order[i]] && got.variance[i] == want.variance[order[i]]));
    }
  }
}

}  // namespace ngs
