#include <doctest/doctest.h>

#include <algorithm>

#include "ngs/core/error.h"
#include "ngs/cut/evidence/variance_stage.h"
#include "ngs/cut/masks/rasterise_prompt.h"
#include "ngs/edit/extract/extract_stage.h"
#include "ngs/edit/select/touched_pieces.h"
#include "visit.h"

namespace ngs {

using test::labels_of, test::mark_two_views, test::Visit;

TEST_CASE("exported labels equal the shown ones if most Gaussians are unseen") {
  const Visit visit(2, true);
  live::Session session(visit.exec, visit.model());
  mark_two_views(visit, session);
  Scene scene;
  scene.objects = {SceneObject{}};
  std::vector<ViewMasks> masks;
  std::vector<ViewSums> strokes;
  std::vector<std::size_t> views;
  for (const auto& view : session.marks()->objects[0].views) {
    views.push_back(scene.views.size());
    scene.views.push_back({view->camera, "", "", Split::kTrain});
    masks.push_back(known_view(view->camera, view->mask));
    const ViewPrompt prompt = rasterise(view->strokes, view->camera.width_px, view->camera.height_px);
    for (ViewSums& s : stroke_weights(visit.exec, visit.scene.cloud, view->camera, prompt, visit.splat))
      strokes.push_back(std::move(s));
  }
  Monitor monitor;
  const Evidence evidence = accumulate_evidence(
      visit.exec, monitor, {visit.scene.cloud, scene, views, visit.splat, [&](std::size_t v) { return masks[v]; }});
  ExtractOptions options;
  options.unseen = UnseenRule::kBackground;
  const LabelColumns labels = label_gaussians({}, evidence)[0];
  const Extraction extracted = extract_object(visit.exec, options, {visit.scene.cloud, labels});
  CHECK(extracted.unseen >= 3000);
  const PieceSelection written = touched_pieces(visit.exec, visit.scene.cloud, extracted.object, strokes);
  const live::ObjectLabels& shown = labels_of(session);
  CHECK(std::vector<float>(written.object.begin(), written.object.end()) == shown.label);
  CHECK(shown.count == std::count(written.object.begin(), written.object.end(), std::uint8_t(1)));
  CHECK(shown.removed == written.removed);
  CHECK(shown.count > 50);
}

TEST_CASE("a piece that no stroke touches is left out, and shown again with all_pieces") {
  Visit visit;
  live::Session session(visit.exec, visit.model());
  const live::Viewpoint viewpoint = visit.viewpoint(0);
  const std::array<double, 2> ball = visit.ball(viewpoint);
  // No background stroke: colours alone decide which part of the wall is selected.
  session.mark(1, viewpoint, {{true, 6, {ball}}});
  const live::ObjectLabels touched = labels_of(session);
  session.show_all_pieces(true);
  const live::ObjectLabels all = labels_of(session);
  CHECK(all.removed == 0);
  CHECK(all.count == touched.count + touched.removed);
  CHECK(session.marks()->all_pieces);
  CHECK(session.undo());
  CHECK(labels_of(session).label == touched.label);
}

TEST_CASE("a stroke on empty pixels is an error and changes nothing") {
  Visit visit;
  live::Session session(visit.exec, visit.model());
  live::Viewpoint away = visit.viewpoint(0);
  away.look_at = away.position - (away.look_at - away.position);
  CHECK_THROWS_AS(session.mark(1, away, {{true, 6, {{90, 70}}}}), Error);
  CHECK(session.marks()->objects[0].views.empty());
  CHECK(session.steps_back() == 0);
}

}  // namespace ngs
