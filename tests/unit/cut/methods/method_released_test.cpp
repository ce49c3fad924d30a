#include "ngs/cut/methods/method_released.h"

#include <doctest/doctest.h>

#include <cmath>

#include "support/method_case.h"
#include "support/random.h"

namespace ngs {
namespace {

struct FieldCase {
  std::vector<float> position;
  std::vector<double> base;
  FieldCase() {
    test::Random random(3);
    position = random.uniform_vector<float>(40 * 3, -1, 1);
    base = random.uniform_vector(40 * 3, 0.2, 0.8);
  }
};

}  // namespace

// The align terms detach their targets, so their sum has no matching finite differences; the three
// other terms are. Central differences with step 1e-5: error below 1e-9.
TEST_CASE("gradients of the released regulariser equal finite differences") {
  const FieldCase c;
  const ReleasedWeights parts[] = {{0, 0, 1, 0}, {0, 0, 0, 1}, {0, 1, 0, 0}};
  for (const ReleasedWeights& weights : parts) {
    CAPTURE(weights.smooth);
    CAPTURE(weights.density);
    ReleasedField field(1);
    for (std::size_t i = 0; i < std::size_t(8 * 2) << 15; ++i)
      field.parameters()[i] *= 2000;  // initial entries of 1e-4 have too little effect
    std::vector<double> grad_base, ignored;
    const auto total = [&](const std::vector<double>& base) {
      return field.evaluate({}, weights, {c.position, base}, 5, ignored).total;
    };
    field.evaluate({.threads = 2}, weights, {c.position, c.base}, 5, grad_base);
    const std::vector<double> grad = field.grad();
    std::vector<std::size_t> moving;
    for (std::size_t i = 0; i < grad.size(); ++i)
      if (grad[i] != 0) moving.push_back(i);
    CHECK((moving.size() > 1000) == (weights.continuity == 0));
    for (std::size_t k = 0; k < 60 && !moving.empty(); ++k) {
      const std::size_t i = moving[k * (moving.size() - 1) / 59];
      const double was = field.parameters()[i];
      field.parameters()[i] = was + 1e-5;
      const double hi = total(c.base);
      field.parameters()[i] = was - 1e-5;
      const double lo = total(c.base);
      field.parameters()[i] = was;
      CHECK(std::abs((hi - lo) / 2e-5 - grad[i]) < 1e-8);
    }
    for (std::size_t i = 0; i < c.base.size(); i += 7) {
      std::vector<double> lo = c.base, hi = c.base;
      lo[i] -= 1e-5;
      hi[i] += 1e-5;
      CHECK(std::abs((total(hi) - total(lo)) / 2e-5 - grad_base[i]) < 1e-8);
    }
  }
}

TEST_CASE("the released regulariser converges to its target, the mean colour of the neighbours") {
  const FieldCase c;
  ReleasedField field(2);
  std::vector<double> grad_base;
  const double before = field.evaluate({}, {}, {c.position, c.base}, 0, grad_base).align;
  for (int i = 0; i < 60; ++i) {
    field.step({}, 1e-2);
    field.evaluate({}, {}, {c.position, c.base}, std::uint64_t(i), grad_base);
  }
  CHECK(field.evaluate({}, {}, {c.position, c.base}, 0, grad_base).align < 0.8 * before);
  CHECK(field.evaluate({}, {}, {{}, {}}, 0, grad_base).total == 0);
}

TEST_CASE("the released code regularises the most uncertain Gaussians, ties in row order") {
  GaussianCloud cloud;
  cloud.resize(6, 0);
  cloud.usable[4] = 0;
  const std::vector<float> logit = {3, 0, -1, 0, 0, -0.5f};
  CHECK(most_undecided(cloud, logit, 3) == std::vector<std::size_t>{1, 3, 5});
  CHECK(most_undecided(cloud, logit, 1) == std::vector<std::size_t>{1});
  CHECK(most_undecided(cloud, logit, 100).size() == 5);
  CHECK(most_undecided(GaussianCloud(), {}, 10).empty());
}

TEST_CASE("released differs from cob in colours, but in no label and no geometry of the first texture phase") {
  const test::MethodCase c = test::method_case(95, 100, 3);
  ReleasedOptions options;
  options.cob.rounds = 1;
  options.cob.rest_lr = options.cob.opacity_lr = options.cob.scale_lr = options.cob.rotation_lr =
      options.cob.position_lr = 0;
  const Solution with = run_released({}, test::Quiet(), options, c.input());
  CobOptions cob = options.cob;
  cob.divisor = CobDivisor::kAll;
  const Solution without = run_cob({}, test::Quiet(), cob, c.input());
  CHECK(with.cloud->sh_dc != without.cloud->sh_dc);
  CHECK(with.cloud->position == without.cloud->position);
  CHECK(with.labels[0].prob == without.labels[0].prob);
  CHECK(with.figures.at("align") > 0);
}

}  // namespace ngs
