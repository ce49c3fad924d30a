#include "ngs/cut/contours/unexplained_contrast.h"

#include <doctest/doctest.h>

#include "ngs/problem/scene_measures.h"
#include "ngs/render/render_stage.h"
#include "support/joint_case.h"

namespace ngs {
namespace {

const std::vector<std::size_t> kViews{0, 1, 2, 3};

/// The value for the case's own photos.
double unexplained(test::JointCase& c) {
  Problem in = c.input();
  in.load_fine_photo = in.load_photo;
  const LabelledModel model{c.model, c.labels};
  return unexplained_contrast({.threads = 2}, in, model, kViews,
                              refine_views({}, {ContourRefineOptions{}, 64, in}, model, kViews, kViews));
}

/// The joint case with labels that miss part of the ball, so that refinement moves contours, and with renderings of the
/// model as photos.
std::unique_ptr<test::JointCase> labelled_case() {
  auto c = test::joint_case();
  c->labels[0].prob = c->labels[0].label = c->is_ball;
  for (std::size_t i = 0; i < 40; ++i) c->labels[0].prob[i] = c->labels[0].label[i] = 0;
  for (std::size_t v = 0; v < 4; ++v) {
    const RenderRequest request;
    c->photos[v] = render({}, c->model, c->scene.views[v].camera, {}, request).colour;
  }
  return c;
}

}  // namespace

TEST_CASE("unexplained contrast is 0 if the photos are renderings of the model") {
  const auto c = labelled_case();
  CHECK(unexplained(*c) < 1e-5);
}

TEST_CASE("unexplained contrast is the residual at moved pixels relative to the contrast") {
  const auto c = labelled_case();
  Problem in = c->input();
  in.load_fine_photo = in.load_photo;
  const LabelledModel model{c->model, c->labels};
  const std::vector<RefinedView> refined = refine_views({}, {ContourRefineOptions{}, 64, in}, model, kViews, kViews);
  double moved = 0;
  for (const RefinedView& view : refined) moved += view.window.w;
  REQUIRE(moved > 0);
  // A constant added to all photos keeps every edge: the residual is 3 channels of 0.02 at each moved pixel.
  const double before = unexplained_contrast({}, in, model, kViews, refined);
  for (ImageF& photo : c->photos)
    for (float& value : photo.data) value += 0.02f;
  const double after = unexplained_contrast({}, in, model, kViews, refined);
  CHECK(before < 1e-5);
  double contrast = 0;
  for (const std::size_t v : kViews) {
    const ViewMasks masks = uncropped_masks(refined[v], 48, 40);
    std::vector<std::uint8_t> mask;
    for (const float m : masks.target[0]) mask.push_back(m > 0.5f);
    contrast += contour_contrast(mask, c->photos[v]) / 4;
  }
  CHECK(after == doctest::Approx(0.06 / contrast).epsilon(1e-3));

  // A difference where no contour moved does not count: here in the first rows of the photos.
  for (ImageF& photo : c->photos)
    for (std::size_t p = 0; p < 3 * 48 * 3; ++p) photo.data[p] += 0.5f;
  CHECK(unexplained_contrast({}, in, model, kViews, refined) == doctest::Approx(after).epsilon(1e-9));
}

TEST_CASE("unexplained contrast without photos, views or moved pixels is 0") {
  const auto c = labelled_case();
  Problem in = c->input();
  const LabelledModel model{c->model, c->labels};
  CHECK(unexplained_contrast({}, in, model, {}, std::vector<RefinedView>(4)) == 0);
  CHECK(unexplained_contrast({}, in, model, kViews, std::vector<RefinedView>(4)) == 0);
}

TEST_CASE("masks reject refined contours only if the closed-form labels lose agreement by refinement too") {
  const auto c = labelled_case();
  Problem in = c->input();
  in.load_fine_photo = in.load_photo;
  const LabelledModel model{c->model, c->labels};
  // Views whose masks are aligned with the photos' edges, and lose agreement by refinement.
  std::vector<RefinedView> worse(4);
  for (std::size_t v = 0; v < 4; ++v) {
    worse[v].compared = true;
    worse[v].rendered_biou = 0.8, worse[v].refined_biou = 0.7 + 0.001 * double(v);
    worse[v].own_contrast = worse[v].refined_contrast = 1;
  }
  const ContourRefineOptions refine;
  const RefineSetup setup{refine, 64, in};
  REQUIRE(mask_agreement_gain(worse) < -kSignificant);

  // The case's closed-form labels miss a part of the ball: refinement brings them closer to the masks.
  REQUIRE(mask_agreement_gain(refine_views({}, setup, model, kViews, kViews)) > 0);
  CHECK_FALSE(masks_reject({}, setup, model, worse));

  in.labels = SharedLabels();
  CHECK(masks_reject({}, setup, model, worse));
  for (RefinedView& view : worse) view.refined_biou = 0.9;
  CHECK_FALSE(masks_reject({}, setup, model, worse));
}

}  // namespace ngs
