#pragma once
// A tiny capture for the joint stage: a ball of Gaussians in front of a wall, seen by four cameras. Photos are renders
// of the true model, masks are those of the ball; the model to be optimised is the true one with shifted colours.
#include <algorithm>
#include <memory>

#include "ngs/core/rng.h"
#include "ngs/cut/evidence/variance_stage.h"
#include "ngs/cut/training/joint_options.h"
#include "ngs/problem/problem.h"
#include "support/quiet.h"
#include "support/splat_shapes.h"

namespace ngs::test {

struct JointCase {
  GaussianCloud truth, model;
  std::vector<float> is_ball;
  Scene scene;
  std::vector<ImageF> photos;
  std::vector<ViewMasks> masks;
  std::vector<LabelColumns> labels;
  BoundaryRule rule{.tau = 0.2};
  std::shared_ptr<const std::vector<float>> weight = nullptr;  // of the labels' evidence

  Problem input() const {
    return {.cloud = model,
            .scene = scene,
            .views = {0, 1, 2, 3},
            .load_masks = [this](std::size_t v) { return masks[v]; },
            .load_photo = [this](std::size_t v) { return photos[v]; },
            .background = {0, 0, 0},
            .seed = 7,
            .labels = labels,
            .rule = rule,
            .weight = weight};
  }
  /// Adds a view that looks the other way, with an empty mask; returns its index.
  std::size_t add_empty_view() {
    const Mat3<double> turned{{-1, 0, 0, 0, 1, 0, 0, 0, -1}};
    SceneView view = scene.views[0];
    view.camera.rotation = turned * view.camera.rotation;
    view.camera.translation = turned * view.camera.translation;
    scene.views.push_back(view);
    photos.push_back(photos[0]);
    masks.push_back(masks[0]);
    std::fill(masks.back().target[0].begin(), masks.back().target[0].end(), 0.f);
    return scene.views.size() - 1;
  }
};

inline constexpr std::int64_t kBeforeBall = 12;

/// Adds small dark Gaussians between the camera and the ball: they cover the ball in this view, and the wall in others.
inline void add_before_ball(const Camera& camera, GaussianCloud& cloud) {
  const Vec3<double> from = camera.centre(), ball{0, 0, 4};
  for (std::int64_t k = 0; k < kBeforeBall; ++k) {
    const std::int64_t column = k % 4, row = k / 4;
    const double x = 0.07 * (double(column) - 1.5), y = 0.07 * (double(row) - 1);
    const Vec3<double> p = from + 0.4 * (ball - from);
    add_gaussian(cloud, p + Vec3<double>{x, y, 0}, 0.05, {-1.2, -1.2, -1.2});
  }
}

/// Few steps of a small field.
inline JointOptions small_joint(std::int64_t steps, int hash_levels, int hash_finest) {
  JointOptions options;
  options.steps = steps;
  options.hash_levels = hash_levels;
  options.hash_finest = hash_finest;
  options.hash_log2_table = 8;
  options.mlp_hidden = 16;
  options.smooth_points = 64;
  return options;
}

/// Camera `v` of four about the ball.
inline Camera joint_camera(int v, int scale) {
  const double focal_px = 60 * scale, middle_px = 19 * scale;
  Camera camera{
      "view" + std::to_string(v) + ".png", 48 * scale, 40 * scale, focal_px, focal_px, 24.5 * scale, middle_px};
  const double angle = 0.12 * (v - 1.5);
  camera.rotation = {{std::cos(angle), 0, std::sin(angle), 0, 1, 0, -std::sin(angle), 0, std::cos(angle)}};
  camera.translation = {-4 * std::sin(angle), 0.05 * v, 4 - 4 * std::cos(angle)};
  return camera;
}

/// `scale`: of the pictures of 48 x 40 pixels.
inline std::unique_ptr<JointCase> joint_case(int ball = 160, int wall = 120, int scale = 1) {
  auto c = std::make_unique<JointCase>();
  std::uint64_t index = 0;
  const auto uniform = [&](double lo, double hi) {
    return float(lo + (hi - lo) * rng_uniform(3, RngStream::kTest, index++));
  };
  GaussianCloud& t = c->truth;
  t.resize(ball + wall, 1);
  for (int i = 0; i < ball + wall; ++i) {
    const auto k = std::size_t(i);
    const bool in_ball = i < ball;
    c->is_ball.push_back(in_ball ? 1.f : 0.f);
    if (in_ball) {
      const double z = 2 * (i + 0.5) / ball - 1, phi = 2.399963 * i, r = std::sqrt(1 - z * z);  // Fibonacci sphere
      t.position[k * 3] = float(0.6 * r * std::cos(phi));
      t.position[k * 3 + 1] = float(0.6 * r * std::sin(phi));
      t.position[k * 3 + 2] = float(4 + 0.6 * z);
    } else {
      t.position[k * 3] = uniform(-2, 2);
      t.position[k * 3 + 1] = uniform(-1.6, 1.6);
      t.position[k * 3 + 2] = uniform(5.6, 5.8);
    }
    t.rotation[k * 4] = 1;
    for (std::size_t a = 0; a < 3; ++a) {
      t.log_scale[k * 3 + a] = in_ball ? uniform(-2.6, -2.2) : uniform(-1.6, -1.2);
      t.sh_dc[k * 3 + a] = in_ball ? uniform(0.2, 1.6) : uniform(-1.4, 0.1);
    }
    t.logit_opacity[k] = uniform(1, 3);
  }
  c->model = t;
  for (float& x : c->model.sh_dc) x += 0.1f;
  c->scene.objects = {{"ball", 0}};
  for (int v = 0; v < 4; ++v) {
    const Camera camera = joint_camera(v, scale);
    c->scene.views.push_back({camera, "", "", Split::kTrain});
    const RenderedView view = render({}, t, camera, {}, {.label = {c->is_ball.data(), t.size(), 1}});
    c->photos.push_back(view.colour);
    ViewMasks masks{camera.width_px, camera.height_px, {std::vector<float>()}, {}, true};
    for (const float m : view.label.data) masks.target[0].push_back(m > 0.5f ? 1.f : 0.f);
    c->masks.push_back(std::move(masks));
  }
  const auto load = [&](std::size_t v) { return c->masks[v]; };
  const Evidence evidence = accumulate_evidence({}, Quiet(), {c->model, c->scene, {0, 1, 2, 3}, {}, load});
  c->labels = label_gaussians(c->rule, evidence);
  return c;
}

}  // namespace ngs::test
