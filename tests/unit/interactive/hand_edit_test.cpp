#include "ngs/interactive/hand_edit.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "ngs/core/error.h"
#include "support/splat_shapes.h"
#include "visit.h"

namespace ngs {
namespace {

using live::EditAction, live::HandEdit;
using test::labels_of, test::Visit;

HandEdit outline(EditAction action, const live::Viewpoint& viewpoint, std::array<double, 4> box) {
  const auto [left, top, right, bottom] = box;
  return {action, viewpoint, {{left, top}, {right, top}, {right, bottom}, {left, bottom}}, false, {}, 0};
}

HandEdit of(EditAction action) { return {action, {}, {}, false, {}, 0}; }

live::HandEdits list_of(std::initializer_list<EditAction> actions) {
  live::HandEdits edits;
  for (const EditAction action : actions) edits.push_back(std::make_shared<const HandEdit>(of(action)));
  return edits;
}

std::int64_t count(const live::ObjectLabels& labels) {
  CHECK(labels.count == std::count(labels.label.begin(), labels.label.end(), 1.f));
  return labels.count;
}

}  // namespace

TEST_CASE_FIXTURE(
    test::Visiting,
    "an outline selects every Gaussian with its centre in it, hidden ones too, and a ball those within it") {
  const double w = viewpoint.width_px, h = viewpoint.height_px;
  session.edit_by_hand(1, outline(EditAction::kAdd, viewpoint, {0, 0, w / 2, h}));
  const Camera camera = live::camera_of(viewpoint);
  const live::ObjectLabels left = labels_of(session);
  std::int64_t wrong = 0, inside = 0;
  for (std::size_t i = 0; i < left.label.size(); ++i) {
    const auto pixel = camera.project(world_position(visit.scene.cloud, i));
    const bool is_left = pixel && pixel->x < w / 2;
    inside += is_left;
    wrong += is_left != (left.label[i] > 0);
  }
  CHECK(inside > 100);
  CHECK(wrong == 0);
  session.edit_by_hand(1, outline(EditAction::kTake, viewpoint, {0, 0, w / 2, h}));
  CHECK(count(labels_of(session)) == 0);

  const auto [x, y] = visit.ball(viewpoint);
  const live::Model model = visit.model();
  const HandEdit ball = live::ball_at(visit.exec, model.cloud, model.splat, viewpoint, {x, y, 12});
  session.edit_by_hand(1, ball);
  CHECK(visit.selected(labels_of(session), true) > 3);
  CHECK(visit.selected(labels_of(session), false) == 0);  // the wall lies behind
  live::Viewpoint away = viewpoint;
  away.look_at = 2.0 * away.position - away.look_at;
  CHECK_THROWS_AS(live::ball_at(visit.exec, model.cloud, model.splat, away, {x, y, 12}), Error);
}

TEST_CASE_FIXTURE(test::Visiting,
                  "an outline of what is visible only leaves out the Gaussians behind the ball, and adds the ball") {
  const auto [x, y] = visit.ball(viewpoint);
  HandEdit lasso = outline(EditAction::kAdd, viewpoint, {x - 9, y - 9, x + 9, y + 9});
  session.edit_by_hand(1, lasso);
  const std::int64_t of_ball = visit.selected(labels_of(session), true);
  CHECK(visit.selected(labels_of(session), false) > 0);
  CHECK(session.undo());
  lasso.visible_only = true;
  session.edit_by_hand(1, lasso);
  CHECK(visit.selected(labels_of(session), true) > 0);
  CHECK(visit.selected(labels_of(session), true) <= of_ball);
  CHECK(visit.selected(labels_of(session), false) == 0);
}

TEST_CASE_FIXTURE(test::Visiting, "inverting twice, and undoing every edit, restores the labels") {
  session.mark(1, viewpoint, {visit.on_ball(viewpoint), Visit::on_wall(viewpoint)});
  const std::vector<float> strokes = labels_of(session).label;
  session.edit_by_hand(1, of(EditAction::kInvert));
  CHECK(count(labels_of(session)) == std::count(strokes.begin(), strokes.end(), 0.f));
  session.edit_by_hand(1, of(EditAction::kInvert));
  CHECK(labels_of(session).label == strokes);
  session.edit_by_hand(1, outline(EditAction::kTake, viewpoint, {0, 0, 192, 144}));
  CHECK(count(labels_of(session)) == 0);
  // A later stroke changes the labels below; the edit still holds.
  session.mark(1, viewpoint, {visit.on_ball(viewpoint)});
  CHECK(count(labels_of(session)) == 0);
  for (int k = 0; k < 4; ++k) CHECK(session.undo());
  CHECK(labels_of(session).label == strokes);
  // Results of earlier edits are cached; many edits and steps back give the labels of a new session.
  std::vector<std::vector<float>> after;
  for (const double x : {20.0, 60.0, 100.0, 140.0, 180.0, 190.0}) {
    session.edit_by_hand(1, outline(x < 70 ? EditAction::kTake : EditAction::kAdd, viewpoint, {x, 20, x + 30, 120}));
    after.push_back(labels_of(session).label);
  }
  for (std::size_t k = after.size() - 1; k > 0; --k) {
    CHECK(session.undo());
    CHECK(labels_of(session).label == after[k - 1]);
  }
}

TEST_CASE("growing adds the neighbours of the edge and shrinking takes them again") {
  GaussianCloud cloud;
  test::add_floor(cloud, 2, 0, 0.1);  // 40 x 40 on a grid
  classify(cloud);
  const live::Model model{cloud, {}, {0, 0, 0}};
  live::ObjectLabels labels = live::ObjectLabels::none(1600);
  const auto is_within = [&](std::size_t i, double half) {
    return std::abs(cloud.position[3 * i]) < half && std::abs(cloud.position[3 * i + 1]) < half;
  };
  for (std::size_t i = 0; i < 1600; ++i) {
    labels.label[i] = is_within(i, 1);
    labels.count += is_within(i, 1);
  }
  REQUIRE(labels.count == 400);
  std::vector<live::ObjectLabels> grown;
  for (const int threads : {1, 3}) {
    const live::HandEdits grow = list_of({EditAction::kGrow});
    grown.push_back(live::with_edits({.threads = threads}, model, labels, grow));
  }
  CHECK(grown[0].label == grown[1].label);
  for (std::size_t i = 0; i < 1600; ++i) {
    if (is_within(i, 1.09)) CHECK(grown[0].label[i] == 1);  // the next ring
    if (!is_within(i, 1.31)) CHECK(grown[0].label[i] == 0);
  }
  const live::HandEdits both = list_of({EditAction::kGrow, EditAction::kShrink});
  const live::ObjectLabels again = live::with_edits({}, model, labels, both);
  CHECK(count(again) < count(grown[0]));
  for (std::size_t i = 0; i < 1600; ++i) {
    if (is_within(i, 0.89)) CHECK(again.label[i] == 1);  // one ring of the edge may differ
    if (!is_within(i, 1.11)) CHECK(again.label[i] == 0);
  }
}

TEST_CASE_FIXTURE(
    test::Visiting,
    "a locked object keeps its Gaussians from other objects and does not change; a hidden one is not drawn") {
  session.mark(1, viewpoint, {visit.on_ball(viewpoint), Visit::on_wall(viewpoint)});
  const std::int64_t ball = labels_of(session).count;
  const live::FrameRequest request{live::camera_of(viewpoint), live::Layer::kBoth, 0.5, 0, true};
  const auto frame = [&] { return live::draw_frame(visit.exec, visit.model(), *session.shown(), request); };
  const ImageU8 before = frame();
  session.set_locked(1, true);
  const HandEdit everything = outline(EditAction::kAdd, viewpoint, {0, 0, 192, 144});
  CHECK_THROWS_AS(session.edit_by_hand(1, everything), Error);
  CHECK_THROWS_AS(session.mark(1, viewpoint, {visit.on_ball(viewpoint)}), Error);
  const int other = session.add_object("rest");
  session.edit_by_hand(other, everything);
  const live::ObjectLabels &first = labels_of(session, 0), &rest = labels_of(session, 1);
  for (std::size_t i = 0; i < first.label.size(); ++i) CHECK(first.label[i] + rest.label[i] < 2);
  session.set_locked(1, false);
  CHECK(labels_of(session, 1).count >= rest.count + ball);
  session.set_hidden(other, true);
  CHECK(frame().data != before.data);
  CHECK_THROWS_AS(session.mark(1, viewpoint, {visit.on_ball(viewpoint)}), Error);
  for (int k = 0; k < 5; ++k) CHECK(session.undo());
  CHECK(frame().data == before.data);
}

}  // namespace ngs
