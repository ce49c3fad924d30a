// A scene in another unit of length has the same labels, masks and cameras: no constant is an absolute length.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "ngs/capture/scene_check.h"
#include "ngs/cut/training/joint_trainer.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/orbit/orbit_stage.h"
#include "ngs/render/render_options.h"
#include "support/joint_case.h"
#include "support/splat_shapes.h"

namespace ngs {
namespace {

// Positions are scaled by powers of two without rounding; log_scale is not, so footprints differ in the last bits.
constexpr double kExact[] = {0x1p-10, 0x1p10}, kRounded[] = {1e-3, 1e3};

void scale(GaussianCloud& cloud, double factor) {
  for (float& x : cloud.position) x = float(factor * double(x));
  for (float& s : cloud.log_scale) s = float(double(s) + std::log(factor));
}

test::JointCase scaled_case(double factor) {
  test::JointCase c = *test::joint_case();
  scale(c.truth, factor);
  scale(c.model, factor);
  for (SceneView& view : c.scene.views) {
    view.camera.translation = factor * view.camera.translation;
    view.image_path = "photo";
    view.mask_path = "mask";
  }
  return c;
}

/// Checks model and photos, as import does, and adopts the renderer that the check finds.
SceneCheck check(test::JointCase& c) {
  const SceneLoaders loaders{[&](std::size_t v) { return c.photos[v]; },
                             [&](std::size_t v) {
                               return MaskSample{c.masks[v], {}, false};
                             }};
  SceneCheck found = check_scene({}, test::Quiet(), {}, {&c.model, c.scene, loaders, true});
  c.scene.compat = found.compat;
  c.scene.world_unit = found.world_unit;
  return found;
}

Problem problem_of(const test::JointCase& c) {
  Problem input = c.input();
  input.splat = splat_options({}, c.model, c.scene);
  return input;
}

/// Thresholded labels, boundary flags and rendered masks.
struct Labels {
  std::vector<std::uint8_t> label, boundary, mask;

  std::size_t differences(const Labels& other) const {
    const auto count = [](const auto& a, const auto& b) {
      std::size_t n = 0;
      for (std::size_t i = 0; i < a.size(); ++i) n += a[i] != b[i];
      return n;
    };
    return count(label, other.label) + count(boundary, other.boundary) + count(mask, other.mask);
  }
};

Labels labels_of(test::JointCase& c) {
  const SplatOptions splat = splat_options({}, c.model, c.scene);
  const Evidence evidence = accumulate_evidence(
      {}, test::Quiet(), {c.model, c.scene, {0, 1, 2, 3}, splat, [&](std::size_t v) { return c.masks[v]; }});
  c.labels = label_gaussians(c.rule, evidence);
  Labels out;
  const std::vector<float> label = c.labels[0].label.values();
  for (const float x : label) out.label.push_back(x >= 0.5f);
  for (const auto x : c.labels[0].boundary.values()) out.boundary.push_back(x != 0);
  for (const SceneView& view : c.scene.views) {
    RenderRequest request{.colour = false, .label = {label.data(), c.model.size(), 1}};
    for (const float m : render({}, c.model, view.camera, splat, request).label.data) out.mask.push_back(m > 0.5f);
  }
  return out;
}

/// Labels of a few training steps with field and rays, the boundary sampled again.
std::vector<std::uint8_t> trained_labels(const test::JointCase& c) {
  const JointOptions options = test::small_joint(8, 4, 64);
  SampleOptions sample{.rows = 12, .cols = 12, .depth_samples = 4};
  Monitor monitor;
  const RbfOptions rbf;
  const Problem input = problem_of(c);
  JointTrainer trainer({}, monitor, {options, sample, rbf, input, nullptr}, false);
  while (!trainer.finished()) trainer.step();
  std::vector<std::uint8_t> out;
  const Solution solution = trainer.result();
  for (const LabelColumns& object : solution.labels)
    for (const float x : object.label.values()) out.push_back(x >= 0.5f);
  return out;
}

}  // namespace

TEST_CASE("a scene scaled by 2^-10 or 2^10 has the same labels and masks; by 1/1000 or 1000 within 3 pixels") {
  test::JointCase plain = scaled_case(1);
  const SceneCheck found = check(plain);
  CHECK(plain.scene.world_unit == 1);
  CHECK(found.warnings.empty());
  const Labels expected = labels_of(plain);
  REQUIRE(std::ranges::count(expected.label, 1) > 100);
  REQUIRE(std::ranges::count(expected.mask, 1) > 400);
  const auto differences = [&](double factor) {
    CAPTURE(factor);
    test::JointCase c = scaled_case(factor);
    const SceneCheck check_of_scaled = check(c);
    CHECK(check_of_scaled.compat == Compat::kInria);
    CHECK(check_of_scaled.median_fit_db == doctest::Approx(found.median_fit_db).epsilon(1e-3));
    return labels_of(c).differences(expected);
  };
  for (const double factor : kExact) CHECK(differences(factor) == 0);
  for (const double factor : kRounded) CHECK(differences(factor) <= 3);
}

TEST_CASE("training with field and rays labels a scaled scene like the original") {
  test::JointCase plain = scaled_case(1);
  check(plain);
  labels_of(plain);
  const std::vector<std::uint8_t> expected = trained_labels(plain);
  for (const double factor : {0x1p-10, 0x1p10, 1e-3, 1e3}) {
    CAPTURE(factor);
    test::JointCase c = scaled_case(factor);
    check(c);
    labels_of(c);
    const std::vector<std::uint8_t> found = trained_labels(c);
    REQUIRE(found.size() == expected.size());
    std::size_t different = 0;
    for (std::size_t i = 0; i < found.size(); ++i) different += found[i] != expected[i];
    CHECK(different <= 2);
  }
}

TEST_CASE("query points of a scaled scene are the scaled query points") {
  const auto sampled = [](double factor) {
    test::JointCase c = scaled_case(factor);
    check(c);
    labels_of(c);
    SampleOptions sample;
    sample.rows = sample.cols = 6;
    sample.depth_samples = 3;
    sample.depth_span = 1e-6;  // the least window decides
    sample.world_unit = c.scene.world_unit;
    const BoundarySet boundary = boundary_set(c.model, c.labels[0].boundary.values());
    return sample_queries({}, test::Quiet(), sample,
                          {c.model, boundary, c.scene, {0, 1}, splat_options({}, c.model, c.scene)});
  };
  const QueryField plain = sampled(1), small = sampled(0x1p-10);
  REQUIRE(plain.size() > 0);
  REQUIRE(plain.size() == small.size());
  CHECK(small.depth_epsilon == 0x1p-10 * plain.depth_epsilon);
  for (std::size_t i = 0; i < plain.depth.size(); ++i)
    CHECK(1024 * small.depth[i] == doctest::Approx(plain.depth[i]).epsilon(1e-5));
}

TEST_CASE("orbit cameras of a scaled model are the scaled cameras, and show the same") {
  GaussianCloud cloud;
  test::add_box(cloud, {-0.8, -0.4, 0}, {0.8, 0.4, 0.5}, 0.08);
  test::add_sphere(cloud, {0.6, 0.1, 0.8}, 0.35, 300);
  const auto cameras_of = [&](const GaussianCloud& model) {
    return orbit::choose_cameras({}, test::Quiet(), model, {.up = UpAxis::kZ, .around = {}}, {160, 120});
  };
  const orbit::OrbitCameras plain = cameras_of(cloud);
  CHECK(plain.world_unit == 1);
  const auto alpha_of = [](const GaussianCloud& model, const orbit::OrbitCameras& found) {
    RenderRequest request{.colour = false, .label = {}};
    return render({}, model, found.cameras.front(), {.world_unit = found.world_unit}, request).alpha.data;
  };
  const std::vector<float> expected = alpha_of(cloud, plain);
  for (const double factor : {0x1p-10, 0x1p10, 1e-3, 1e3}) {
    CAPTURE(factor);
    GaussianCloud model = cloud;
    scale(model, factor);
    const orbit::OrbitCameras found = cameras_of(model);
    REQUIRE(found.cameras.size() == plain.cameras.size());
    CHECK(found.coverage == doctest::Approx(plain.coverage).epsilon(1e-3));
    for (std::size_t i = 0; i < found.cameras.size(); ++i) {
      const Vec3<double> off = (1 / factor) * found.cameras[i].centre() - plain.cameras[i].centre();
      CHECK(std::sqrt(dot(off, off)) < 1e-4 * plain.radius);
    }
    const std::vector<float> shown = alpha_of(model, found);
    float most = 0;
    for (std::size_t p = 0; p < shown.size(); ++p) most = std::max(most, std::abs(shown[p] - expected[p]));
    CHECK(most < 1e-3f);
  }
}

}  // namespace ngs
