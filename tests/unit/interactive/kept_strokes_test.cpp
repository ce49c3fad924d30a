#include "ngs/interactive/kept_strokes.h"

#include <doctest/doctest.h>

#include "visit.h"

namespace ngs {

using test::labels_of, test::mark_two_views, test::Visit;

TEST_CASE("a refined result that drops the object keeps what strokes cover and lists the rest as dropped") {
  const Visit visit;
  live::Session session(visit.exec, visit.model());
  mark_two_views(visit, session);
  const live::ObjectLabels& selected = labels_of(session);
  const live::ObjectMarks& marks = session.marks()->objects[0];
  const std::size_t n = selected.label.size();
  const live::KeptStrokes none =
      live::keep_under_strokes(visit.exec, visit.model(), live::ObjectLabels::none(n), marks);
  CHECK(none.restored > 5);
  CHECK(none.restored == none.labels.count);
  CHECK(none.labels.count < selected.count);
  CHECK(none.dropped.count > selected.count / 4);
  for (std::size_t i = 0; i < n; ++i) CHECK(none.labels.label[i] + none.dropped.label[i] <= selected.label[i]);
  CHECK(visit.selected(none.labels, false) <= 2);
  // The pixels under the strokes show the object again.
  for (const auto& view : marks.views) {
    RenderRequest request;
    request.label = {none.labels.label.data(), visit.scene.cloud.size(), 1};
    const RenderedView seen = render(visit.exec, visit.scene.cloud, view->camera, visit.splat, request);
    const auto [x, y] = visit.ball(view->viewpoint);
    CHECK(seen.label.at(int(x), int(y), 0) > 0.5f * seen.alpha.at(int(x), int(y), 0));
  }
}

TEST_CASE("a refined result that agrees with the strokes is unchanged, also beyond the selection") {
  const Visit visit;
  live::Session session(visit.exec, visit.model());
  mark_two_views(visit, session);
  live::ObjectLabels refined = labels_of(session);
  for (std::size_t i = 0; i < refined.label.size(); ++i)
    if (visit.scene.is_object[i] > 0 && refined.label[i] == 0) refined.label[i] = 1, ++refined.count;
  const live::KeptStrokes kept =
      live::keep_under_strokes(visit.exec, visit.model(), refined, session.marks()->objects[0]);
  CHECK(kept.labels.label == refined.label);
  CHECK(kept.restored == 0);
  CHECK(kept.dropped.count == 0);
}

}  // namespace ngs
