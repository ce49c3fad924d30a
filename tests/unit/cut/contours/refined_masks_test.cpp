#include "ngs/cut/contours/refined_masks.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "ngs/cut/contours/unexplained_contrast.h"
#include "ngs/problem/scene_measures.h"
#include "ngs/render/render_stage.h"
#include "ngs/scene/mask_threshold.h"
#include "support/joint_case.h"

namespace ngs {
namespace {

/// Compared views. Agreement with the given masks rises by `gain` through refinement. `beyond_px2`, `short_px2`: pixels
/// only in the given, only in the refined masks. `contrast`: of the given contours, relative to the refined ones.
std::vector<RefinedView> views(double gain, double contrast, double beyond_px2, double short_px2) {
  std::vector<RefinedView> some(4);
  for (std::size_t v = 0; v < some.size(); ++v) {
    some[v].compared = true;
    some[v].rendered_biou = 0.5;
    some[v].refined_biou = 0.5 + gain + (v % 2 == 0 ? 0.002 : -0.002);
    some[v].own_contrast = contrast;
    some[v].refined_contrast = 1;
    some[v].beyond_px2 = beyond_px2;
    some[v].short_px2 = short_px2;
  }
  return some;
}

bool masks_reject(const std::vector<RefinedView>& refined) { return mask_agreement_gain(refined) < -kSignificant; }

}  // namespace

TEST_CASE("aligned masks reject refined contours that agree less, whichever side the masks err to") {
  CHECK(masks_reject(views(-0.01, 0.9, 10, 0)));
  CHECK(masks_reject(views(-0.01, 0.9, 10, 10)));
  CHECK_FALSE(masks_reject(views(-0.001, 0.9, 10, 10)));  // within two standard errors
  CHECK_FALSE(masks_reject(views(0.01, 0.9, 10, 10)));
}

TEST_CASE("misaligned masks can reject only if they err to both sides alike") {
  CHECK(masks_reject(views(-0.01, 0.5, 10, 8)));
  CHECK_FALSE(masks_reject(views(-0.01, 0.5, 10, 1)));
  CHECK_FALSE(masks_reject(views(-0.01, 0.5, 1, 10)));
  CHECK_FALSE(masks_reject(views(-0.001, 0.5, 10, 8)));
}

TEST_CASE("one-sided errors are summed over all views") {
  std::vector<RefinedView> both = views(-0.01, 0.5, 10, 1);
  for (const RefinedView& other : views(-0.01, 0.5, 1, 10)) both.push_back(other);
  CHECK_FALSE(masks_err_to_one_side(both));
  CHECK(masks_err_to_one_side(views(-0.01, 0.5, 10, 1)));
}

TEST_CASE("refinement and comparison in a crop about the object give the bits of the whole image") {
  const auto c = test::joint_case();
  Camera& camera = c->scene.views[0].camera;
  camera.width_px = 120;
  camera.height_px = 100;
  for (const double cx : {70.5, 9.0}) {  // inside the image, and cut by its edge
    CAPTURE(cx);
    camera.cx = cx;
    camera.cy = 41;
    const Camera fine = resized(camera, 240, 200);
    const SplatOptions splat = filter_at_scale({}, 2);
    const ImageF photo = render({}, c->truth, fine, splat, {}).colour;
    const LabelChannels label({}, c->model, c->labels);
    const ImageF own = label.view({}, camera, {});
    ViewMasks& masks = c->masks[0] = {120, 100, {own.data}, {}, true};
    std::rotate(masks.target[0].begin(), masks.target[0].begin() + 2, masks.target[0].end());
    for (float& m : masks.target[0]) m = label_is_foreground(m) ? 1.f : 0.f;
    Problem in = c->input();
    in.load_fine_photo = [&](std::size_t) { return photo; };
    const ContourRefineOptions refine{.band_px = 3, .reach_px = 4};
    const RefinedView got = refine_views({}, {refine, 5, in}, {c->model, c->labels}, {0}, {0})[0];

    std::vector<std::uint8_t> mask;
    for (const float x : label.view({}, fine, splat).data) mask.push_back(label_is_foreground(x));
    const std::vector<float> soft = refine_contour(refine, {mask.data(), 240, 200}, photo);
    std::vector<float> target(120 * 100);
    for (std::size_t p = 0; p < soft.size(); ++p)
      target[p / 240 / 2 * 120 + p % 240 / 2] += label_is_foreground(soft[p]) ? 0.25f : 0.f;
    CHECK(uncropped_masks(got, 120, 100).target[0] == target);
    std::vector<std::uint8_t> a, b;
    double beyond = 0;
    for (std::size_t p = 0; p < target.size(); ++p) {
      a.push_back(mask_is_foreground(target[p]));
      b.push_back(mask_is_foreground(masks.target[0][p]));
      beyond += b[p] && !a[p];
    }
    CHECK(got.refined_biou == boundary_iou({}, chessboard_distance({a.data(), 120, 100}),
                                           chessboard_distance({b.data(), 120, 100}), 120, 1));
    CHECK(got.refined_biou < 1);
    CHECK(got.beyond_px2 == beyond);
    CHECK(beyond > 0);
    CHECK(std::count(a.begin(), a.end(), 1) < 120 * 100 / 8);
  }
}

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
    worse[v].rendered_biou = 0.8;
    worse[v].refined_biou = 0.7 + 0.001 * double(v);
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
