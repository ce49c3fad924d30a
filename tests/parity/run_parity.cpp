// Whole runs with the device path, against the CPU: evidence, then the passes of --method ngs.
#include <cmath>

#include "ngs/cut/passes/exposure/exposure.h"
#include "ngs/make/fit/fit_stage.h"
#include "parity/backends.h"
#include "support/changed_rows.h"
#include "support/joint_case.h"
#include "support/pipeline_case.h"

namespace ngs::test {
namespace {

TrainingOptions short_training() {
  TrainingOptions training;
  training.joint.steps = 12;
  return training;
}

/// Gaussians whose value differs in some bit.
template <class Column>
std::int64_t differing(const Column& got, const Column& want, std::size_t n) {
  std::int64_t count = 0;
  for (std::size_t i = 0; i < n; ++i) count += float(got[i]) != float(want[i]);
  return count;
}

FitState fit_start(const JointCase& c) {
  FitState state;
  state.cloud = c.model;
  state.gradient_sum.resize(std::size_t(c.model.size()));
  state.gradient_views = state.gradient_sum;
  return state;
}

}  // namespace

TEST_CASE("run: a fit with densification on a device equals the CPU's, bit by bit with its functions") {
  const auto c = joint_case(120, 80);
  std::vector<FitView> views;
  for (std::size_t v = 0; v < 4; ++v) views.push_back({c->scene.views[v].camera, c->photos[v], Split::kTrain});
  FitOptions options;
  options.steps = 14;
  options.sh_degree = 1;
  options.sh_every = 5;
  options.near_loss = 0.01;
  options.densify_from = 6;
  options.densify_every = 4;
  options.densify_until = 10;
  options.densify_gradient = 1e-6;
  const auto fit = [&](const Exec& exec) {
    auto fitter = std::make_unique<Fitter>(options, views, fit_start(*c), 3);
    run_fit(exec, test::Quiet(), *fitter, options, {});
    return fitter;
  };
  const auto want = fit({});
  REQUIRE(want->state().cloud.size() > c->model.size());  // it was densified
  for (const Backend& b : backends()) {
    const auto got = fit(b.exec);
    const GaussianCloud &w = want->state().cloud, &g = got->state().cloud;
    REQUIRE(g.size() == w.size());
    check_ratio(b, "fit loss", std::abs(got->last_loss().total / want->last_loss().total - 1) / 1.2e-7, 500);
    check_ratio(b, "fit positions", worst_ratio(g.position, w.position, largest(w.position)), 500);
    check_ratio(b, "fit opacities", worst_ratio(g.logit_opacity, w.logit_opacity, largest(w.logit_opacity)), 5000);
    if (b.same_functions) check_same_bits(g, w);
  }
}

TEST_CASE("run: exposures of a device equal the CPU's within rounding") {
  const auto c = joint_case();
  for (float& x : c->photos[1].data) x *= 0.8f;
  const Problem in = c->input();
  const std::vector<ViewExposure> want = view_exposures({}, in, in.views);
  REQUIRE(want[1].gain[0] < 0.9f);
  for (const Backend& b : backends()) {
    const std::vector<ViewExposure> got = view_exposures(b.exec, in, in.views);
    REQUIRE(got.size() == want.size());
    for (std::size_t v = 0; v < want.size(); ++v)
      for (std::size_t k = 0; k < 3; ++k)
        check_ratio(b, "exposure gain", std::abs(double(got[v].gain[k]) / double(want[v].gain[k]) - 1) / 1.2e-7, 500);
  }
}

TEST_CASE("run: evidence and all passes with a device give the CPU's labels, bit by bit with its functions") {
  const auto c = joint_case();
  for (SceneView& view : c->scene.views) view.image_path = view.camera.name;  // so that photos are used
  const auto n = std::size_t(c->model.size());
  const auto load = [&](std::size_t v) { return c->masks[v]; };
  const auto labels_of = [&](const Exec& exec) {
    return label_gaussians(c->rule,
                           accumulate_evidence(exec, test::Quiet(), {c->model, c->scene, {0, 1, 2, 3}, {}, load}))[0];
  };
  const LabelColumns want_start = labels_of({});
  const TrainingOptions training = short_training();
  const Problem in = c->input();
  PipelineCase cpu(in, training, {});
  const Solution& want = *cpu.run().solution;
  REQUIRE(differing(want.labels[0].label, in.labels[0].label, n) > 0);  // the run trains labels
  for (const Backend& b : backends()) {
    CAPTURE(b.name);
    const LabelColumns got_start = labels_of(b.exec);
    for (std::size_t i = 0; i < n; ++i) CHECK(got_start.label[i] == want_start.label[i]);
    if (b.same_functions) CHECK(got_start.prob == want_start.prob);
    PipelineCase device(in, training, {}, all_passes(), b.exec);
    const Solution& got = *device.run().solution;
    for (std::size_t i = 0; i < n; ++i) {
      CHECK((got.labels[0].label[i] > 0.5f) == (want.labels[0].label[i] > 0.5f));
      CHECK(std::abs(got.labels[0].prob[i] - want.labels[0].prob[i]) < 1e-3f);
    }
    if (b.same_functions) {
      CHECK(got.labels[0].label == want.labels[0].label);
      CHECK(got.labels[0].prob == want.labels[0].prob);
      check_same_bits(*got.cloud, *want.cloud);
    }
    MESSAGE(b.name << ": other bits than on the CPU: probabilities of evidence "
                   << differing(got_start.prob, want_start.prob, n) << " of " << n << ", of the run "
                   << differing(got.labels[0].prob, want.labels[0].prob, n) << " of "
                   << differing(want.labels[0].prob, in.labels[0].prob, n) << " trained, colours "
                   << differing(got.cloud->sh_dc, want.cloud->sh_dc, 3 * n) << " of "
                   << differing(want.cloud->sh_dc, c->model.sh_dc, 3 * n) << " trained");
  }
}

}  // namespace ngs::test
