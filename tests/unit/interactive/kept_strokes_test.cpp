#include "ngs/interactive/kept_strokes.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "ngs/core/error.h"
#include "ngs/cut/evidence/variance_stage.h"
#include "ngs/cut/masks/rasterise_prompt.h"
#include "ngs/edit/extract/extract_stage.h"
#include "ngs/edit/select/touched_pieces.h"
#include "support/splat_shapes.h"
#include "visit.h"

namespace ngs {

using test::labels_of, test::mark_two_views, test::Visit;

namespace {

/// Lattices of solid Gaussians, 0.1 apart: {corner, number along each axis}.
GaussianCloud lattices(const std::vector<std::array<double, 6>>& blocks) {
  GaussianCloud cloud;
  for (const auto& block : blocks) {
    const Vec3<double> corner{block[0], block[1], block[2]};
    for (int z = 0; z < int(block[5]); ++z)
      for (int y = 0; y < int(block[4]); ++y)
        for (int x = 0; x < int(block[3]); ++x)
          test::add_gaussian(cloud, corner + 0.1 * Vec3<double>{double(x), double(y), double(z)}, 0.05);
  }
  classify(cloud);
  return cloud;
}

}  // namespace

TEST_CASE_FIXTURE(test::Visiting, "a refined result that drops the object keeps the part that strokes cover") {
  mark_two_views(visit, session);
  const live::ObjectLabels& selected = labels_of(session);
  const live::ObjectMarks& marks = session.marks()->objects[0];
  const std::size_t n = selected.label.size();
  const live::RestoredSelection none =
      live::restore_under_strokes(visit.exec, visit.model(), live::ObjectLabels::none(n), marks);
  CHECK(none.restored > 5);
  CHECK(none.restored == none.labels.count);
  CHECK(none.labels.count > selected.count / 2);
  CHECK(none.dropped.count == 0);
  for (std::size_t i = 0; i < n; ++i) CHECK(none.labels.label[i] + none.dropped.label[i] <= selected.label[i]);
  CHECK(visit.selected(none.labels, false) <= 2);
  // The pixels under the strokes show the object again.
  for (const auto& view : marks.views) {
    RenderRequest request{.label = {none.labels.label.data(), visit.scene.cloud.size(), 1}};
    const RenderedView seen = render(visit.exec, visit.scene.cloud, view->camera, visit.splat, request);
    const auto [x, y] = visit.ball(view->viewpoint);
    CHECK(seen.label.at(int(x), int(y), 0) > 0.5f * seen.alpha.at(int(x), int(y), 0));
  }
}

TEST_CASE_FIXTURE(test::Visiting,
                  "a refined result that agrees with the strokes is unchanged, also beyond the selection") {
  mark_two_views(visit, session);
  live::ObjectLabels refined = labels_of(session);
  for (std::size_t i = 0; i < refined.label.size(); ++i)
    if (visit.scene.is_object[i] > 0 && refined.label[i] == 0) {
      refined.label[i] = 1;
      ++refined.count;
    }
  const live::RestoredSelection found =
      live::restore_under_strokes(visit.exec, visit.model(), refined, session.marks()->objects[0]);
  CHECK(found.labels.label == refined.label);
  CHECK(found.restored == 0);
  CHECK(found.dropped.count == 0);
}

TEST_CASE("a part that a thin neck carries comes back if the stroke runs over it; what a stroke grazes stays dropped") {
  // A head of 216 Gaussians, a neck of 40 and a body of 216; a block far from them, on whose edge the stroke ends; a
  // wall.
  const GaussianCloud cloud = lattices({{-0.25, -1, 0, 6, 6, 6},
                                        {-0.05, -0.4, 0.2, 2, 10, 2},
                                        {-0.25, 0.6, 0, 6, 6, 6},
                                        {2, 0.6, 0, 6, 6, 6},
                                        {-4, -3, 3, 80, 60, 1}});
  constexpr std::size_t kBody = 256, kBlock = 472, kWall = 688;
  const Exec exec;
  SplatOptions splat;
  splat = prepared_for(exec, splat, cloud);
  const live::Viewpoint viewpoint{{0, 0, -5}, {0, 0, 0}, {0, -1, 0}, 50, 192, 144};
  live::MarkedView view;
  view.name = "0001.png";
  view.viewpoint = viewpoint;
  const Camera camera = live::camera_of(viewpoint);
  const auto pixel = [&](double x, double y) {
    return std::array<double, 2>{camera.fx * x / 5 + camera.cx, camera.fy * y / 5 + camera.cy};
  };
  view.strokes.width_px = viewpoint.width_px;
  view.strokes.height_px = viewpoint.height_px;
  view.strokes.strokes = {{true, 3, {pixel(0, -0.75), pixel(0, 0.85), pixel(2, 0.85)}}};
  std::vector<float> masked(std::size_t(cloud.size()));
  std::fill_n(masked.begin(), kWall, 1.f);
  const RenderedView seen = render(exec, cloud, camera, splat, {.label = {masked.data(), cloud.size(), 1}});
  for (const float label : seen.label.data) view.mask.push_back(label > 0.5f);
  live::ObjectMarks marks{.id = 1, .name = {}, .colour = {}, .views = {std::make_shared<const live::MarkedView>(view)}};
  live::ObjectLabels refined = live::ObjectLabels::none(std::size_t(cloud.size()));
  std::fill(refined.label.begin() + kBody, refined.label.begin() + kBlock, 1.f);
  refined.count = std::int64_t(kBlock - kBody);

  const live::RestoredSelection found = live::restore_under_strokes(exec, {cloud, splat, {0, 0, 0}}, refined, marks);
  const auto count = [](const live::ObjectLabels& labels, std::size_t first, std::size_t last) {
    return std::count(labels.label.begin() + std::ptrdiff_t(first), labels.label.begin() + std::ptrdiff_t(last), 1.f);
  };
  CHECK(count(found.labels, 0, 216) >= 36);  // the head's front
  CHECK(count(found.labels, 216, kBody) >= 20);
  CHECK(count(found.dropped, 0, kBody) == 0);
  CHECK(count(found.labels, kBody, kBlock) == std::int64_t(kBlock - kBody));
  CHECK(count(found.dropped, kBlock, kWall) > 10);
  CHECK(count(found.labels, kBlock, kWall) < 70);
  CHECK(count(found.labels, kWall, masked.size()) == 0);
}

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
  ExtractOptions options{.unseen = UnseenRule::kBackground};
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
