// Which labels the joint steps train: cells (Gaussian, object), only for objects whose region contains the Gaussian.
#include "ngs/cut/training/trained_labels.h"

#include <doctest/doctest.h>

#include "ngs/math/stable.h"

namespace ngs {
namespace {

/// Two objects and six Gaussians: one of the first object, one of the second, one of both, one of neither, one unseen,
/// one fixed by hand.
struct Cells {
  GaussianCloud cloud;
  Scene scene;
  std::vector<LabelColumns> labels{2};

  Cells() {
    cloud.resize(6, 0);
    labels[0].prob = {0.9f, 0, 0.4f, 0, 0.9f, 0.9f}, labels[1].prob = {0, 0.8f, 0.5f, 0.005f, 0, 0};
    for (LabelColumns& object : labels) {
      for (const auto column : {&LabelColumns::label, &LabelColumns::variance, &LabelColumns::boundary})
        (object.*column).assign(6, 0.f);
      object.views = {3, 3, 3, 3, 0, 3};
    }
  }
  Problem problem(std::vector<std::uint8_t> region) const {
    return {.cloud = cloud, .scene = scene, .fixed = {0, 0, 0, 0, 0, 1}, .labels = labels, .region = std::move(region)};
  }
};

/// The labels that a step with gradient 1 everywhere changes, each as "gaussian,object ".
std::string changed_by_step(const Cells& cells, const std::vector<std::uint8_t>& region) {
  const Problem in = cells.problem(region);
  GaussianCloud all = cells.cloud;
  const TrainedRows rows({}, region, {}, all);
  TrainedLabels trained(rows);
  trained.start(in, 1);
  const Matrix<const float> drawn = trained.rendered();
  const std::vector<float> before(drawn.data, drawn.data + 12);
  const AdamGroup group = trained.group({}, 0.1, std::vector<float>(rows.size() * 2, 1.f));
  adam_step({}, 1, {&group, 1});
  trained.write_back({});
  std::vector<LabelColumns> written = cells.labels;
  trained.write(written);
  std::string changed;
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t k = 0; k < 2; ++k) {
      const float now = trained.rendered().data[2 * i + k];
      if (now == before[2 * i + k]) {
        CHECK(written[k].prob[i] == cells.labels[k].prob[i]);
        CHECK(written[k].label[i] == cells.labels[k].label[i]);
        continue;
      }
      CHECK(now < before[2 * i + k]);
      CHECK(written[k].prob[i] == now);
      CHECK(written[k].label[i] == now);
      changed += std::to_string(i) + "," + std::to_string(k) + " ";
    }
  return changed;
}

}  // namespace

TEST_CASE("trained labels: those of the objects whose region contains the Gaussian; all objects if none does") {
  const Cells cells;
  CHECK(changed_by_step(cells, {1, 1, 1, 1, 1, 1}) == "0,0 1,1 2,0 2,1 3,0 3,1 ");
  CHECK(changed_by_step(cells, {0, 1, 0, 0, 1, 1}) == "1,1 ");
  CHECK(changed_by_step(cells, {}) == "0,0 0,1 1,0 1,1 2,0 2,1 3,0 3,1 ");
}

TEST_CASE("trained labels: a step is an Adam step on the log-odds, for any number of threads") {
  const Cells cells;
  const std::vector<std::uint8_t> region{1, 1, 1, 1, 1, 1};
  const Problem in = cells.problem(region);
  GaussianCloud all = cells.cloud;
  const TrainedRows rows({}, region, {}, all);
  std::vector<float> grad(12);
  for (std::size_t i = 0; i < 12; ++i) grad[i] = 0.1f * float(i + 1);
  const auto stepped = [&](int threads) {
    TrainedLabels trained(rows);
    trained.start(in, 1);
    const std::vector<float> start = trained.logit();
    const Exec exec{.threads = threads};
    const AdamGroup group = trained.group(exec, 0.1, grad);
    adam_step(exec, 1, {&group, 1});
    CHECK(trained.moments().m[1] == doctest::Approx(0.1 * grad[3] * sigmoid_slope(start[1])));  // of (1, 1)
    return trained.logit();
  };
  CHECK(stepped(1).size() == 6);
  CHECK(stepped(1) == stepped(3));
}

}  // namespace ngs
