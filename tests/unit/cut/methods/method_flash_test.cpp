#include "ngs/cut/methods/method_flash.h"

#include <doctest/doctest.h>

#include <cmath>

#include "ngs/cut/evidence/method_labels.h"
#include "ngs/cut/evidence/variance_stage.h"
#include "ngs/cut/methods/method_bce.h"
#include "ngs/cut/methods/method_sa3d.h"
#include "support/method_case.h"

namespace ngs {
namespace {

/// Shares of two objects for hand-made rows; views = 0 if both are negative.
std::vector<LabelColumns> shares(const std::vector<std::vector<float>>& prob) {
  std::vector<LabelColumns> out;
  for (const auto& p : prob) {
    LabelColumns c;
    for (const float f : p) {
      c.prob.push_back(std::max(f, 0.f));
      c.views.push_back(f < 0 ? 0.f : 3.f);
      c.label.push_back(0.f);
      c.variance.push_back(0.f);
      c.boundary.push_back(0.f);
    }
    out.push_back(c);
  }
  return out;
}

struct HandMade {
  GaussianCloud cloud;
  Scene scene;
  std::vector<LabelColumns> run(const std::vector<std::vector<float>>& prob, const FlashOptions& options,
                                std::vector<float> fixed = {}) {
    cloud.resize(std::int64_t(prob[0].size()), 0);
    scene.objects.resize(prob.size());
    std::vector<LabelColumns> labels = shares(prob);
    for (LabelColumns& c : labels)
      if (!fixed.empty()) c.label = fixed;
    const Problem input{cloud, scene, {}, {}, {}, {}, {}, 0, std::move(fixed), std::move(labels)};
    return run_flash({}, test::Quiet(), options, input).labels;
  }
};

}  // namespace

TEST_CASE("flash without bias is the majority of brute-force rendering weights") {
  int compared = 0, scenes_at_a_threshold = 0;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    CAPTURE(seed);
    const test::MethodCase c = test::method_case(seed, 60, 3);
    const auto [weight, object_weight, spread, clear] = test::reference_weights(c);
    if (!clear) {
      ++scenes_at_a_threshold;
      continue;
    }
    const Solution got = run_flash({.threads = 2}, test::Quiet(), {}, c.input());
    for (std::size_t i = 0; i < weight.size(); ++i) {
      CHECK((got.labels[0].views[i] > 0) == (weight[i] > 0));
      if (std::abs(object_weight[i] - 0.5 * weight[i]) < 1e-4 * weight[i]) continue;
      CHECK(got.labels[0].label[i] == float(object_weight[i] > 0.5 * weight[i]));
      compared += weight[i] > 0;
    }
  }
  CHECK(compared > 150);
  CHECK(scenes_at_a_threshold <= 2);
}

TEST_CASE("flash thresholds equal the tie of the two normalised shares, by the norms of paper and code") {
  const double gamma[5] = {-0.8, -0.7, 0, 0.4, 0.75};
  const double l1[5] = {0.10, 0.15, 0.5, 0.70, 0.875}, l2[5] = {0.157, 0.215, 0.5, 0.647, 0.813};  // paper.md §5.4
  for (int i = 0; i < 5; ++i) {
    CHECK(flash_threshold({gamma[i], FlashNorm::kL1}) == doctest::Approx(l1[i]).epsilon(1e-9));
    CHECK(std::abs(flash_threshold({gamma[i], FlashNorm::kL2}) - l2[i]) < 6e-4);
    const double f = flash_threshold({gamma[i], FlashNorm::kL2}), length = std::hypot(f, 1 - f);
    CHECK(f / length == doctest::Approx((1 - f) / length + gamma[i]).epsilon(1e-12));  // the tie itself
  }
}

TEST_CASE("flash never labels a Gaussian without evidence, whatever the bias") {
  HandMade scene;
  const auto labels = scene.run({{0.2f, -1.f, 0.f}}, {-1.0, FlashNorm::kL2});
  CHECK(labels[0].label == std::vector<float>{1, 0, 0});
}

TEST_CASE("flash assigns a Gaussian to the heaviest object, and a tie to the first") {
  HandMade scene;
  const std::vector<std::vector<float>> prob = {{0.4f, 0.3f, 0.6f, 0.1f}, {0.5f, 0.3f, 0.6f, 0.2f}};
  const auto exclusive = scene.run(prob, {});
  CHECK(exclusive[0].label == std::vector<float>{0, 0, 1, 0});  // a tie goes to the first object
  CHECK(exclusive[1].label == std::vector<float>{1, 0, 0, 0});
}

TEST_CASE("flash keeps the labels that were fixed by hand") {
  HandMade scene;
  const auto labels = scene.run({{0.1f, 0.1f, 0.9f}}, {}, {1.f, 0.f, 0.f});
  CHECK(labels[0].label == std::vector<float>{1, 0, 1});
}

TEST_CASE("sa3d in one pass is a threshold of lambda / (1 + lambda) on the same statistic") {
  const test::MethodCase c = test::method_case(3, 60, 4);
  const Solution got = run_sa3d({}, test::Quiet(), {.gate_iou = 0, .passes = 1}, c.input());
  const Solution want = run_flash({}, test::Quiet(), {.gamma = 2 * 0.3 / 1.3 - 1}, c.input());
  CHECK(got.labels[0].label == want.labels[0].label);
  CHECK(got.labels[0].prob == want.labels[0].prob);
  CHECK(got.figures.at("object_gaussians") > 5);
}

TEST_CASE("sa3d skips a view whose mask contradicts the labels, except the first") {
  test::MethodCase c = test::method_case(3, 400, 4);
  for (float& m : c.masks[2].target[0]) m = 1 - m;
  Sa3dOptions options{.gate_iou = 0.3, .passes = 1};
  const Solution gated = run_sa3d({}, test::Quiet(), options, c.input());
  CHECK(gated.figures.at("views_accepted") == 3);
  c.scene.views.erase(c.scene.views.begin() + 2);
  c.masks.erase(c.masks.begin() + 2);
  const Solution without = run_sa3d({}, test::Quiet(), options, c.input());
  CHECK(gated.labels[0].label == without.labels[0].label);
  c.scene.views.resize(1);
  c.masks.resize(1);
  options.gate_iou = 1;
  CHECK(run_sa3d({}, test::Quiet(), options, c.input()).figures.at("views_accepted") == 1);
}

TEST_CASE("sa3d's second pass renders the scene without the Gaussians that the first pass rejected") {
  const test::MethodCase c = test::method_case(5, 400, 3);
  Sa3dOptions options{.gate_iou = 0, .passes = 1};
  const Solution first = run_sa3d({}, test::Quiet(), options, c.input());
  options.passes = 2;
  const Solution second = run_sa3d({}, test::Quiet(), options, c.input());
  GaussianCloud left = c.cloud;
  for (std::size_t i = 0; i < left.usable.size(); ++i) left.usable[i] = first.labels[0].label[i] > 0;
  Evidence evidence(left.size(), 1);
  for (std::size_t v = 0; v < c.masks.size(); ++v)
    add_view_evidence({}, left, {c.scene.views[v].camera, c.masks[v]}, {}, evidence);
  int changed = 0;
  for (std::size_t i = 0; i < left.usable.size(); ++i) {
    const bool object = evidence.object_weight(i, 0) > 0.3 / 1.3 * evidence.weight.value(i);
    CHECK(second.labels[0].label[i] == float(object));
    changed += second.labels[0].label[i] != first.labels[0].label[i];
  }
  CHECK(changed > 0);
}

TEST_CASE("bce improves on the closed form it starts from and certifies the result") {
  const test::MethodCase c = test::method_case(70, 200, 4);
  const BceResult r = solve_bce({}, test::Quiet(), {}, c.input());
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
  Problem input = c.input();
  std::vector<LabelColumns> labels = closed_form_labels({}, test::Quiet(), input);
  input.fixed.assign(80, 0.f);
  for (std::size_t i = 0; i < 80; i += 2) {
    input.fixed[i] = 1.f;
    labels[0].label[i] = float(i % 4 == 0);
  }
  input.labels = std::move(labels);
  const Solution r = solve_bce({}, test::Quiet(), {}, input).method;
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
  const Solution r = solve_bce({}, test::Quiet(), {}, c.input()).method;
  double shared = 0;
  for (std::size_t i = 0; i < 150; ++i) {
    CHECK(r.labels[0].label[i] + r.labels[1].label[i] <= 1.f);
    shared += double(r.labels[0].prob[i] * r.labels[1].prob[i]);
  }
  CHECK(shared > 10);
  CHECK(r.figures.count("gap_object1") == 1);
}

}  // namespace ngs
