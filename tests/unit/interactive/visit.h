#pragma once
// A test session on the tiny scene: the ball's pixel in each view, and the selected Gaussians.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "ngs/interactive/session.h"
#include "support/tiny_scene.h"

namespace ngs::test {

/// The viewpoint with the view of a camera of the tiny scene.
inline live::Viewpoint viewpoint_of(const Camera& camera, int width_px) {
  const Mat3<double>& r = camera.rotation;
  const Vec3<double> at = camera.centre(), down{r(1, 0), r(1, 1), r(1, 2)}, forward{r(2, 0), r(2, 1), r(2, 2)};
  const double fov_y_deg = 360 / std::numbers::pi * std::atan(0.5 * camera.height_px / camera.fy);
  return {at, at + forward, -1.0 * down, fov_y_deg, width_px, width_px * 3 / 4};
}

/// The tiny scene, the ball's pixel in each view, and a session on it.
struct Visit {
  explicit Visit(int threads = 2, bool in_museum = false) {
    exec.threads = threads;
    if (in_museum) test::add_unseen(scene.cloud);
    scene.is_object.resize(std::size_t(scene.cloud.size()));
    splat = prepared_for(exec, splat, scene.cloud);
  }
  live::Model model() const { return {scene.cloud, splat, {0, 0, 0}}; }
  live::Viewpoint viewpoint(std::size_t view) const { return viewpoint_of(scene.cameras[view], 192); }

  /// The pixel of the ball's centre.
  std::array<double, 2> ball(const live::Viewpoint& viewpoint) const {
    Vec3<double> sum{0, 0, 0};
    double count = 0;
    for (std::size_t i = 0; i < scene.is_object.size(); ++i)
      if (scene.is_object[i] > 0) {
        const float* p = &scene.cloud.position[3 * i];
        sum = sum + Vec3<double>{double(p[0]), double(p[1]), double(p[2])};
        ++count;
      }
    const Camera camera = live::camera_of(viewpoint);
    const Vec3<double> at = camera.rotation * ((1 / count) * sum) + camera.translation;
    return {camera.fx * at.x / at.z + camera.cx, camera.fy * at.y / at.z + camera.cy};
  }
  PromptStroke on_ball(const live::Viewpoint& viewpoint) const { return {true, 6, {ball(viewpoint)}}; }
  static PromptStroke on_wall(const live::Viewpoint& viewpoint) {
    return {false, 5, {{8, 8}, {double(viewpoint.width_px) - 8, 8}}};
  }
  /// Gaussians of the ball, or of the wall, that are selected.
  std::int64_t selected(const live::ObjectLabels& labels, bool of_ball) const {
    std::int64_t count = 0;
    for (std::size_t i = 0; i < labels.label.size(); ++i)
      count += labels.label[i] > 0 && (scene.is_object[i] > 0) == of_ball;
    return count;
  }

  Exec exec;
  test::TinyScene scene = test::tiny_scene();
  SplatOptions splat;
};

inline const live::ObjectLabels& labels_of(const live::Session& session, std::size_t object = 0) {
  const auto shown = session.shown();
  REQUIRE(shown->size() > object);
  REQUIRE((*shown)[object].labels);
  return *(*shown)[object].labels;
}

/// The marks as stored in a file.
inline live::Marks plain_marks(const live::Session& session) {
  live::Marks kept{.objects = {}, .active = 1, .next_id = 2};
  for (const live::ObjectMarks& object : session.marks()->objects) {
    kept.objects.push_back({object.id, object.name, object.colour, object.next_view, {}});
    for (const auto& view : object.views) {
      live::MarkedView plain;
      plain.name = view->name;
      plain.viewpoint = view->viewpoint;
      plain.strokes = view->strokes;
      plain.mask = view->mask;
      kept.objects.back().views.push_back(std::make_shared<const live::MarkedView>(plain));
    }
  }
  return kept;
}

inline void mark_two_views(const Visit& visit, live::Session& session) {
  for (const std::size_t view : {0u, 3u}) {
    const live::Viewpoint viewpoint = visit.viewpoint(view);
    session.mark(1, viewpoint, {visit.on_ball(viewpoint), Visit::on_wall(viewpoint)});
  }
}

/// The fixture of cases on a session, with two viewpoints.
struct Visiting {
  const Visit visit;
  live::Session session{visit.exec, visit.model()};
  const live::Viewpoint viewpoint = visit.viewpoint(0), other = visit.viewpoint(3);
};

}  // namespace ngs::test
