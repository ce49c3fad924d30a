#include "ngs/cut/methods/method_cob.h"

#include <doctest/doctest.h>

#include <cmath>

#include "ngs/cut/methods/method_flash.h"
#include "support/method_case.h"

namespace ngs {
namespace {

struct SignCounts {
  std::vector<double> contrast;  // [N] Σ over visible views of |n+ - n-| / (n+ + n-)
  std::vector<int> visible;
  bool clear = true;
};

/// Brute-force counters of COB-GS: per view the pixels that a Gaussian touches inside and outside of the
/// mask.
SignCounts sign_counts(const test::MethodCase& c) {
  const auto n = std::size_t(c.cloud.size());
  SignCounts s{std::vector<double>(n), std::vector<int>(n)};
  for (std::size_t v = 0; v < c.view.size(); ++v) {
    std::vector<int> inside(n), outside(n);
    const auto image = test::reference_render(c.view[v], {});
    for (std::size_t p = 0; p < image.size(); ++p) {
      s.clear &= image[p].closest_threshold > 1e-5;
      if (!c.masks[v].known[p]) continue;
      for (const auto& [g, w] : image[p].weight) ++(c.masks[v].target[0][p] > 0.5f ? inside : outside)[std::size_t(g)];
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (inside[i] + outside[i] == 0) continue;
      s.contrast[i] += std::abs(inside[i] - outside[i]) / double(inside[i] + outside[i]);
      ++s.visible[i];
    }
  }
  return s;
}

/// Splits every Gaussian whose pixels disagree, whatever its size.
CobOptions splits_all_sizes() { return {.ambiguity = 0.6, .split_scale = 0}; }

}  // namespace

TEST_CASE("cob's certainty is the brute-force count of agreeing pixels, over visible or over all views") {
  int compared = 0, partly_visible = 0;
  for (std::uint64_t seed = 80; seed < 84; ++seed) {
    const test::MethodCase c = test::method_case(seed, 80, 3);
    const SignCounts want = sign_counts(c);
    if (!want.clear) continue;
    const Problem input = c.input();
    for (const CobDivisor divisor : {CobDivisor::kVisible, CobDivisor::kAll}) {
      CobOptions options{.divisor = divisor};
      CobTrainer trainer(options, input);
      trainer.mask_phase({}, test::Quiet());
      const std::vector<double> got = trainer.certainty();
      for (std::size_t i = 0; i < got.size(); ++i) {
        const int visible = want.visible[i];
        double r = 1;
        if (visible > 0)
          r = divisor == CobDivisor::kVisible ? want.contrast[i] / visible : (want.contrast[i] + 3 - visible) / 3;
        CHECK(got[i] == doctest::Approx(r).epsilon(1e-8));
        compared += visible > 0;
        partly_visible += visible > 0 && visible < 3;
      }
    }
  }
  CHECK(compared > 200);
  CHECK(partly_visible > 0);
}

TEST_CASE("cob splits ambiguous Gaussians in two, keeps their source row and resets their labels") {
  const test::MethodCase c = test::method_case(85, 120, 3);
  const Problem input = c.input();
  const CobOptions options = splits_all_sizes();
  CobTrainer trainer(options, input);
  trainer.mask_phase({}, test::Quiet());
  const std::vector<double> certain = trainer.certainty();
  std::vector<std::int64_t> chosen, want;
  for (std::int64_t i = 0; i < 120; ++i)
    if (certain[std::size_t(i)] < 0.6)
      chosen.push_back(i);
    else
      want.push_back(i);
  REQUIRE(chosen.size() > 3);
  for (const std::int64_t i : chosen) {
    want.push_back(i);
    want.push_back(i);
  }
  trainer.split({});
  CHECK(trainer.source_row() == want);
  const GaussianCloud& after = trainer.cloud();
  REQUIRE(after.size() == 120 + std::int64_t(chosen.size()));
  for (std::size_t r = 120 - chosen.size(); r < want.size(); ++r) {
    const auto parent = std::size_t(want[r]);
    double scaled = 0;  // (child - parent) in units of the parent's axes, squared: chi-square with 3 degrees of freedom
    double inv;
    const float* q = &c.cloud.rotation[parent * 4];
    const Mat3<double> turn =
        rotation_matrix(normalised(Vec4<double>{double(q[0]), double(q[1]), double(q[2]), double(q[3])}, inv));
    const float *p = &after.position[r * 3], *p0 = &c.cloud.position[parent * 3];
    const Vec3<double> local =
        transpose(turn) * Vec3<double>{double(p[0] - p0[0]), double(p[1] - p0[1]), double(p[2] - p0[2])};
    for (std::size_t k = 0; k < 3; ++k) {
      scaled += std::pow((&local.x)[k] / std::exp(double(c.cloud.log_scale[parent * 3 + k])), 2);
      CHECK(after.log_scale[r * 3 + k] == doctest::Approx(double(c.cloud.log_scale[parent * 3 + k]) - std::log(1.6)));
    }
    CHECK(scaled > 1e-3);
    CHECK(scaled < 40);
    CHECK(after.sh_dc[r * 3] == c.cloud.sh_dc[parent * 3]);
    CHECK(trainer.logit()[r] == 0.f);
  }
  CHECK(std::any_of(trainer.logit().begin(), trainer.logit().end(), [](float x) { return x != 0.f; }));
}

TEST_CASE("cob splits only Gaussians above the size limit that are not fixed by hand") {
  const test::MethodCase c = test::method_case(85, 120, 3);
  Problem input = c.input();
  CobOptions options = splits_all_sizes();
  options.split_scale = 10;
  CobTrainer large(options, input);
  large.mask_phase({}, test::Quiet());
  large.split({});
  CHECK(large.cloud().size() == 120);
  options.split_scale = 0;
  input.fixed.assign(120, 1.f);
  CobTrainer fixed(options, input);
  fixed.mask_phase({}, test::Quiet());
  fixed.split({});
  fixed.prune({});
  CHECK(fixed.cloud().size() == 120);
}

TEST_CASE("cob's pruning deletes exactly the ambiguous Gaussians and keeps the others' labels with them") {
  const test::MethodCase c = test::method_case(86, 120, 3);
  const Problem input = c.input();
  const CobOptions options = splits_all_sizes();
  CobTrainer trainer(options, input);
  trainer.mask_phase({}, test::Quiet());
  const std::vector<double> certain = trainer.certainty();
  std::vector<std::int64_t> left;
  for (std::int64_t i = 0; i < 120; ++i)
    if (certain[std::size_t(i)] >= 0.6) left.push_back(i);
  const std::vector<float> logit = trainer.logit();
  REQUIRE(left.size() < 117);
  trainer.prune({});
  const Solution r = trainer.result(test::Quiet());
  CHECK(r.source_row == left);
  CHECK(r.figures.at("pruned") == 120.0 - double(left.size()));
  REQUIRE(r.labels[0].prob.size() == left.size());
  for (std::size_t row = 0; row < left.size(); ++row)
    if (r.labels[0].views[row] > 0)
      CHECK(r.labels[0].prob[row] == doctest::Approx(1 / (1 + std::exp(-double(logit[std::size_t(left[row])])))));
}

TEST_CASE("cob's trained labels equal a clear majority of the weights") {
  const test::MethodCase c = test::method_case(87, 150, 6);
  const Solution got = run_cob({}, test::Quiet(), {.rounds = 0}, c.input());
  const Solution majority = run_flash({}, test::Quiet(), {}, c.input());
  int clear = 0;
  for (std::size_t i = 0; i < 150; ++i) {
    const LabelColumns& m = majority.labels[0];
    if (m.views[i] < 6 || std::abs(m.prob[i] - 0.5f) < 0.3f) continue;
    CHECK(got.labels[0].label[i] == m.label[i]);
    ++clear;
  }
  CHECK(clear > 20);
  CHECK(got.source_row.size() == 150);
}

TEST_CASE("cob's texture phases lower the photometric loss and change geometry") {
  const test::MethodCase c = test::method_case(88, 120, 4);
  const Solution r = run_cob({}, test::Quiet(), {.rounds = 3}, c.input());
  CHECK(r.figures.at("texture_steps") == 24);
  CHECK(r.figures.at("label_steps") == 32);
  CHECK(r.figures.at("last_photometric_loss") < r.figures.at("first_photometric_loss"));
  CHECK(r.labels[0].label.size() == std::size_t(r.cloud->size()));
  CHECK(r.source_row.size() == std::size_t(r.cloud->size()));
}

TEST_CASE("cob fails for texture phases without photos, with a hint") {
  const test::MethodCase c = test::method_case(89, 40, 2);
  Problem input = c.input();
  input.load_photo = nullptr;
  CHECK_THROWS_AS(run_cob({}, test::Quiet(), {}, input), Error);
  CHECK_NOTHROW(run_cob({}, test::Quiet(), {.rounds = 0}, input));
}

}  // namespace ngs
