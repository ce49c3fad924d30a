// The passes of --method ngs with a device, against the CPU: decisions, contours, floaters.
#include <algorithm>
#include <cmath>

#include "ngs/cut/contours/contour_stage.h"
#include "ngs/cut/contours/refined_masks.h"
#include "ngs/cut/passes/floaters/floaters.h"
#include "parity/backends.h"
#include "support/changed_rows.h"
#include "support/joint_case.h"
#include "support/pipeline_case.h"

namespace ngs::test {
namespace {

/// A model with floaters before the ball in view 0, and with a ball that is larger than in the photos.
std::unique_ptr<JointCase> damaged_case() {
  auto c = joint_case();
  for (std::size_t i = 0; i < c->is_ball.size(); ++i)
    for (std::size_t k = 0; k < 3 && c->is_ball[i] > 0; ++k) c->model.log_scale[3 * i + k] += 0.35f;
  add_before_ball(c->scene.views[0].camera, c->model);
  for (SceneView& view : c->scene.views) view.image_path = view.camera.name;  // so that photos are used
  const auto load = [&](std::size_t v) { return c->masks[v]; };
  c->labels =
      label_gaussians(c->rule, accumulate_evidence({}, test::Quiet(), {c->model, c->scene, {0, 1, 2, 3}, {}, load}));
  return c;
}

Problem input_of(const JointCase& c) {
  Problem in = c.input();
  in.load_fine_photo = in.load_photo;
  return in;
}

void check_same_rows(const Backend& b, const Solution& got, const Solution& want, const GaussianCloud& before) {
  REQUIRE(got.cloud->size() == want.cloud->size());
  CHECK(got.source_row == want.source_row);
  CHECK(changed_rows(*got.cloud, before, got.source_row) == changed_rows(*want.cloud, before, want.source_row));
  if (b.same_functions) check_same_bits(*got.cloud, *want.cloud);
  std::int64_t others = 0;
  for (std::size_t i = 0; i < want.labels[0].label.size(); ++i) {
    CHECK((got.labels[0].label[i] > 0.5f) == (want.labels[0].label[i] > 0.5f));
    CHECK(std::abs(got.labels[0].prob[i] - want.labels[0].prob[i]) < 1e-2f);
    others += float(got.labels[0].prob[i]) != float(want.labels[0].prob[i]);
  }
  if (b.same_functions) CHECK(others == 0);
  MESSAGE(b.name << ": " << others << " of " << want.labels[0].label.size() << " probabilities have other bits");
}

}  // namespace

TEST_CASE("passes: heuristics measured with a device equal the CPU's within rounding, and so do the decisions") {
  const auto c = damaged_case();
  const Problem in = input_of(*c);
  const TrainingOptions training;
  PipelineCase cpu(in, training, {});
  const std::vector<Decision> want = cpu.decide().all();
  CHECK(std::ranges::count_if(want, [](const Decision& d) { return d.measured.has_value(); }) > 8);
  for (const Backend& b : backends()) {
    PipelineCase device(in, training, {}, all_passes(), b.exec);
    const std::vector<Decision> got = device.decide().all();
    REQUIRE(got.size() == want.size());
    for (std::size_t i = 0; i < want.size(); ++i) {
      CAPTURE(std::string(want[i].effect->name));
      CHECK(got[i].on == want[i].on);
      REQUIRE(got[i].measured.has_value() == want[i].measured.has_value());
      if (!want[i].measured) continue;
      const double measured = *got[i].measured, on_cpu = *want[i].measured;
      CHECK((std::isnan(on_cpu) ? std::isnan(measured) : measured == doctest::Approx(on_cpu).epsilon(1e-4)));
    }
  }
}

TEST_CASE("passes: masks refined with a device on several threads are those of the CPU") {
  const auto c = damaged_case();
  const Problem in = input_of(*c);
  const ContourOptions options;
  const std::vector<std::size_t> views{0, 1, 2, 3};
  const auto refined = [&](const Exec& exec) {
    return refine_views(exec, {options.refine, 4, in, 2}, {in.cloud, in.labels}, views, views);
  };
  const std::vector<RefinedView> want = refined({});
  for (const Backend& b : backends()) {
    CAPTURE(b.name);
    Exec exec = b.exec;
    exec.threads = 3;
    const std::vector<RefinedView> got = refined(exec);
    for (const std::size_t v : views) {
      REQUIRE(want[v].masks.available());
      CHECK(got[v].masks.unpacked().target == want[v].masks.unpacked().target);
      CHECK(got[v].refined_biou == want[v].refined_biou);
    }
  }
}

TEST_CASE("passes: floaters found with a device are the CPU's, and the refit model equals the CPU's within rounding") {
  const auto c = damaged_case();
  const Problem in = input_of(*c);
  const FloaterFinding want = find_floaters({}, test::Quiet(), {}, in);
  REQUIRE(want.count == kBeforeBall);
  const RefitOptions refit{.epochs = 2};
  const FloaterRemoval removed = remove_floaters({}, test::Quiet(), refit, in, want);
  REQUIRE(removed.figures.at("uncovered") > 0);
  const std::vector<std::uint8_t> changed = changed_rows(removed.cloud, c->model);
  REQUIRE(std::ranges::count(changed, std::uint8_t(1)) > kBeforeBall);  // the refit changed more rows
  for (const Backend& b : backends()) {
    CAPTURE(b.name);
    const FloaterFinding got = find_floaters(b.exec, test::Quiet(), {}, in);
    CHECK(got.floater == want.floater);
    CHECK(got.far == want.far);
    const FloaterRemoval fitted = remove_floaters(b.exec, test::Quiet(), refit, in, want);
    for (const auto& figure : removed.figures) {
      CAPTURE(figure.first);
      CHECK(fitted.figures.at(figure.first) == doctest::Approx(figure.second).epsilon(1e-5));
    }
    CHECK(changed_rows(fitted.cloud, c->model) == changed);
    if (b.same_functions) check_same_bits(fitted.cloud, removed.cloud);
    for (const GroupColumns& column : kGroupColumns)
      check_ratio(
          b, std::string("refit, ") + column.name,
          worst_ratio(fitted.cloud.*column.value, removed.cloud.*column.value, largest(removed.cloud.*column.value)),
          2000);
  }
}

TEST_CASE("passes: floaters, joint steps and contours with a device change the CPU's rows and label its side") {
  const auto c = damaged_case();
  const Problem in = input_of(*c);
  TrainingOptions training;
  training.joint.steps = 4;
  const std::vector<std::string> on{"floaters=on", "components=on", "mask-outliers=on",      "exposure=on",
                                    "contours=on", "split=on",      "contour-iterations=on", "bleed-through=on"};
  const auto run = [&](const Exec& exec) {
    auto passes = std::make_unique<PipelineCase>(in, training, on, all_passes(), exec);
    passes->set("contour_epochs", "3");
    passes->set("contour_iterations", "2");
    passes->run();
    return passes;
  };
  const auto cpu = run({});
  const Solution& want = cpu->solution();
  REQUIRE(cpu->report()["floaters"]["removed"] == kBeforeBall);
  REQUIRE(want.figures.at("contour_iterations") == 2);
  REQUIRE(want.cloud->size() > c->model.size());  // straddling Gaussians were halved
  for (const Backend& b : backends()) {
    CAPTURE(b.name);
    const auto device = run(b.exec);
    CHECK(device->report()["floaters"]["removed"] == kBeforeBall);
    check_same_rows(b, device->solution(), want, c->model);
  }
}

}  // namespace ngs::test
