#include "ngs/interactive/session.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "ngs/core/error.h"
#include "ngs/cut/evidence/variance_stage.h"
#include "ngs/cut/methods/method_flash.h"
#include "visit.h"

namespace ngs {

using test::labels_of, test::mark_two_views, test::plain_marks, test::Visit;

TEST_CASE_FIXTURE(test::Visiting, "strokes on two views select the ball and not the wall") {
  const live::StrokeAnswer answer = session.mark(1, viewpoint, {visit.on_ball(viewpoint), Visit::on_wall(viewpoint)});
  CHECK(answer.coverage > 0.01);
  CHECK(answer.coverage < 0.5);
  session.mark(1, other, {visit.on_ball(other), Visit::on_wall(other)});
  CHECK(visit.selected(labels_of(session), true) > 70);  // of 150: the far side is unseen
  CHECK(visit.selected(labels_of(session), false) < 8);
  CHECK(session.marks()->objects[0].views.size() == 2);
  CHECK(session.marks()->objects[0].strokes() == 4);
}

TEST_CASE_FIXTURE(test::Visiting,
                  "the labels are bit-identical to those of ngs-variance and flash over the same masks") {
  mark_two_views(visit, session);
  const live::Viewpoint again = visit.viewpoint(0);
  session.mark(1, again, {{true, 3, {visit.ball(again)}}});  // a correction removes the view's first mask from the sums
  Scene scene;
  scene.objects = {SceneObject{}};
  std::vector<ViewMasks> masks;
  for (const auto& view : session.marks()->objects[0].views) {
    scene.views.push_back({view->camera, "", "", Split::kTrain});
    masks.push_back({view->camera.width_px, view->camera.height_px, {}, {}, true});
    masks.back().target.emplace_back(view->mask.begin(), view->mask.end());
  }
  REQUIRE(masks.size() == 2);
  Monitor monitor;
  const MaskLoader load = [&](std::size_t view) { return masks[view]; };
  const Evidence evidence =
      accumulate_evidence(visit.exec, monitor, {visit.scene.cloud, scene, {0, 1}, visit.splat, load});
  const Problem problem{.cloud = visit.scene.cloud,
                        .scene = scene,
                        .views = {0, 1},
                        .load_masks = load,
                        .splat = visit.splat,
                        .labels = SharedLabels(label_gaussians({}, evidence))};
  const Solution flash = run_flash(visit.exec, monitor, {}, problem);
  const live::ObjectLabels& live = labels_of(session);
  CHECK(live.label == flash.labels[0].label);
  CHECK(live.count > 0);
  const LabelColumn& boundary = problem.labels[0].boundary;
  CHECK(std::equal(boundary.begin(), boundary.end(), live.boundary.begin(), live.boundary.end(),
                   [](float a, std::uint8_t b) { return (a > 0) == (b > 0); }));
}

TEST_CASE("the same strokes give the same masks and labels for any number of threads") {
  std::vector<PixelMask> masks;
  std::vector<std::vector<float>> labels;
  for (const int threads : {1, 3}) {
    const Visit visit(threads);
    live::Session session(visit.exec, visit.model());
    mark_two_views(visit, session);
    masks.push_back(session.marks()->objects[0].views[1]->mask);
    labels.push_back(labels_of(session).label);
  }
  CHECK(masks[0] == masks[1]);
  CHECK(labels[0] == labels[1]);
}

TEST_CASE_FIXTURE(test::Visiting, "undo and redo restore marks and labels bit-identically") {
  CHECK_FALSE(session.undo());
  session.mark(1, viewpoint, {visit.on_ball(viewpoint), Visit::on_wall(viewpoint)});
  const std::vector<float> first = labels_of(session).label;
  session.mark(1, other, {visit.on_ball(other), Visit::on_wall(other)});
  const std::vector<float> second = labels_of(session).label;
  REQUIRE(first != second);
  CHECK(session.undo());
  CHECK(labels_of(session).label == first);
  CHECK(session.redo());
  CHECK(labels_of(session).label == second);
  CHECK_FALSE(session.redo());
  CHECK(session.undo());
  CHECK(session.undo());
  CHECK(session.marks()->objects[0].views.empty());
  CHECK_FALSE((*session.shown())[0].labels);
  session.forget_steps();
  CHECK_FALSE(session.redo());
}

TEST_CASE_FIXTURE(test::Visiting, "background painted on a new view removes Gaussians that the other views selected") {
  session.mark(1, viewpoint, {visit.on_ball(viewpoint), Visit::on_wall(viewpoint)});
  const std::int64_t before = labels_of(session).count;
  const std::array<double, 2> middle = visit.ball(other);
  session.mark(1, other, {{false, 60, {middle}}});
  CHECK(labels_of(session).count < before / 2);
}

TEST_CASE_FIXTURE(test::Visiting,
                  "a background stroke on a new view changes the selection that is seen there only near the stroke") {
  session.mark(1, viewpoint, {visit.on_ball(viewpoint), Visit::on_wall(viewpoint)});
  const std::int64_t before = visit.selected(labels_of(session), true);
  const std::array<double, 2> middle = visit.ball(other);
  session.mark(1, other, {{false, 2, {{middle[0] + 11, middle[1]}}}});  // on the edge of the ball
  CHECK(visit.selected(labels_of(session), true) > before / 2);
  session.mark(1, other, {Visit::on_wall(other)});
  CHECK(visit.selected(labels_of(session), true) > before / 2);
}

TEST_CASE_FIXTURE(test::Visiting, "strokes from one pose in windows of two sizes belong to one view") {
  live::Session one_size(visit.exec, visit.model());
  live::Viewpoint larger = viewpoint;
  larger.width_px *= 2;
  larger.height_px *= 2;
  for (live::Session* s : {&session, &one_size}) s->mark(1, viewpoint, {visit.on_ball(viewpoint)});
  const std::array<double, 2> small{20, 40};
  session.mark(1, larger, {{false, 8, {{2 * small[0], 2 * small[1]}}}});
  one_size.mark(1, viewpoint, {{false, 4, {small}}});
  REQUIRE(session.marks()->objects[0].views.size() == 1);
  CHECK(session.marks()->objects[0].views[0]->mask == one_size.marks()->objects[0].views[0]->mask);
  CHECK(labels_of(session).label == labels_of(one_size).label);
  // What lies outside of the first picture needs a view of its own.
  larger = viewpoint;
  larger.width_px += 80;
  session.mark(1, larger, {{false, 4, {{double(larger.width_px) - 5, 40}}}});
  CHECK(session.marks()->objects[0].views.size() == 2);
}

TEST_CASE_FIXTURE(test::Visiting, "objects are independent: each has its strokes, its labels and its name") {
  session.mark(1, viewpoint, {visit.on_ball(viewpoint), Visit::on_wall(viewpoint)});
  const std::vector<float> ball = labels_of(session).label;
  const int wall = session.add_object("wall");
  CHECK(session.marks()->active == wall);
  PromptStroke wall_stroke = Visit::on_wall(viewpoint), ball_stroke = visit.on_ball(viewpoint);
  wall_stroke.object = true;
  ball_stroke.object = false;
  session.mark(wall, viewpoint, {wall_stroke, ball_stroke});
  CHECK(labels_of(session, 0).label == ball);
  CHECK(labels_of(session, 1).label != ball);
  session.edit_object(wall, "the wall", "#00ff00");
  CHECK(session.marks()->find(wall)->name == "the wall");
  CHECK((*session.shown())[1].colour == std::array<float, 3>{0, 1, 0});
  session.remove_object(1);
  CHECK(session.marks()->objects.size() == 1);
  CHECK_THROWS_AS(session.mark(1, viewpoint, {ball_stroke}), Error);
  CHECK(session.undo());
  CHECK(labels_of(session, 0).label == ball);
  while (session.marks()->objects.size() < live::kMaxObjects) session.add_object("");
  CHECK_THROWS_AS(session.add_object("one too many"), Error);
}

TEST_CASE_FIXTURE(test::Visiting, "a restored session continues as if it had not ended") {
  live::Session opened(visit.exec, visit.model());
  mark_two_views(visit, session);
  opened.restore(plain_marks(session));
  CHECK(labels_of(opened).label == labels_of(session).label);
  CHECK_FALSE(opened.undo());
  const live::Viewpoint viewpoint = visit.viewpoint(1);
  session.mark(1, viewpoint, {visit.on_ball(viewpoint)});
  opened.mark(1, viewpoint, {visit.on_ball(viewpoint)});
  CHECK(opened.marks()->objects[0].views[2]->mask == session.marks()->objects[0].views[2]->mask);
  CHECK(labels_of(opened).label == labels_of(session).label);
}

TEST_CASE_FIXTURE(test::Visiting,
                  "cached views do not change results: each stroke has the same result in a new session") {
  const auto point_right_of_ball = [&](const live::Viewpoint& viewpoint, double dx) {
    const std::array<double, 2> middle = visit.ball(viewpoint);
    return std::array<double, 2>{middle[0] + dx, middle[1]};
  };
  struct Step {
    std::size_t view;
    double dx_px;
    bool object, undo;
  };
  // More views than the cache holds, revisited; undo between strokes on one view and on another.
  const std::vector<Step> steps{{0, 0, true, false},   {0, 30, false, false}, {3, 0, true, false}, {3, 9, false, false},
                                {3, -6, true, true},   {1, 0, true, false},   {0, 8, false, true}, {3, 5, false, false},
                                {1, 40, false, false}, {1, 10, true, false},  {0, -9, true, false}};
  for (const Step& step : steps) {
    CAPTURE(step.view);
    CAPTURE(step.dx_px);
    live::Session fresh(visit.exec, visit.model());
    fresh.restore(plain_marks(session));
    const live::Viewpoint viewpoint = visit.viewpoint(step.view);
    const PromptStroke stroke{step.object, 3, {point_right_of_ball(viewpoint, step.dx_px)}};
    session.mark(1, viewpoint, {stroke});
    fresh.mark(1, viewpoint, {stroke});
    const auto &views = session.marks()->objects[0].views, &wanted = fresh.marks()->objects[0].views;
    REQUIRE(views.size() == wanted.size());
    for (std::size_t v = 0; v < views.size(); ++v) CHECK(views[v]->mask == wanted[v]->mask);
    const live::ObjectLabels &labels = labels_of(session), &all = labels_of(fresh);
    CHECK(labels.label == all.label);
    CHECK(labels.boundary == all.boundary);
    CHECK(labels.count == all.count);
    CHECK(labels.count == std::count(labels.label.begin(), labels.label.end(), 1.f));
    if (step.undo) CHECK(session.undo());
  }
}

TEST_CASE_FIXTURE(
    test::Visiting,
    "a frame drawn with the last-frame cache equals one drawn without, for other labels, layer or camera") {
  live::CachedStill last;
  const auto check = [&](const live::FrameRequest& request) {
    CHECK(live::draw_frame(visit.exec, visit.model(), *session.shown(), request, &last).data ==
          live::draw_frame(visit.exec, visit.model(), *session.shown(), request).data);
  };
  live::FrameRequest request{live::camera_of(visit.viewpoint(0)), live::Layer::kBoth, 0.5, 0, true};
  check(request);
  check(request);
  mark_two_views(visit, session);
  check(request);
  for (const live::Layer layer : {live::Layer::kBoundary, live::Layer::kObject, live::Layer::kBoth}) {
    request.layer = layer;
    check(request);
  }
  request.fade = 0.3;
  check(request);
  request.camera = live::camera_of(visit.viewpoint(3));
  check(request);
  request.highlight = false;
  check(request);
}

TEST_CASE_FIXTURE(test::Visiting, "a frame shows the selection, the object alone and the background alone") {
  mark_two_views(visit, session);
  live::FrameRequest request{live::camera_of(visit.viewpoint(0)), live::Layer::kBoth, 0.5, 0, false};
  const auto draw = [&] { return live::draw_frame(visit.exec, visit.model(), *session.shown(), request); };
  const ImageU8 plain = draw();
  CHECK(plain.data == session.picture(request.camera).data);
  request.highlight = true;
  const ImageU8 marked = draw();
  const std::array<double, 2> middle = visit.ball(visit.viewpoint(0));
  const int x = int(middle[0]), y = int(middle[1]);
  CHECK(std::abs(int(marked.at(x, y, 1)) - int(plain.at(x, y, 1))) > 10);
  CHECK(marked.at(4, 4, 0) == plain.at(4, 4, 0));
  request.layer = live::Layer::kObject;
  const ImageU8 object = draw();
  CHECK(int(object.at(4, 4, 0)) + object.at(4, 4, 1) + object.at(4, 4, 2) == 0);
  CHECK(object.at(x, y, 0) > 60);
  request.layer = live::Layer::kBackground;
  CHECK(draw().at(x, y, 0) < plain.at(x, y, 0));
  request.layer = live::Layer::kBoth;
  request.fade = 0.25;
  request.highlight = false;
  const ImageU8 half = draw();
  CHECK(std::abs(2 * int(half.at(4, 4, 2)) - int(plain.at(4, 4, 2))) <= 2);
  request.layer = live::Layer::kBoundary;
  CHECK(draw().data != plain.data);
}

TEST_CASE_FIXTURE(test::Visiting, "a correction changes only pixels connected to its strokes, towards their side") {
  const auto mask = [&] { return session.marks()->objects[0].views[0]->mask; };
  session.mark(1, viewpoint, {visit.on_ball(viewpoint)});
  const PixelMask first = mask();
  // Colours alone would select otherwise: those under this stroke are the object's.
  const std::array<double, 2> middle = visit.ball(viewpoint);
  session.mark(1, viewpoint, {{false, 1.5, {{middle[0] + 9, middle[1]}}}});
  const PixelMask less = mask();
  std::int64_t added = 0, removed = 0;
  for (std::size_t p = 0; p < first.size(); ++p) {
    added += less[p] && !first[p];
    removed += first[p] && !less[p];
  }
  CHECK(added == 0);
  CHECK(removed > 0);
  session.mark(1, viewpoint, {{true, 4, {{150, 40}}}});
  const PixelMask more = mask();
  removed = 0;
  added = 0;
  for (std::size_t p = 0; p < first.size(); ++p) {
    added += more[p] && !less[p];
    removed += less[p] && !more[p];
  }
  CHECK(added > 0);
  CHECK(removed == 0);
}

}  // namespace ngs
