// Comparison of refined contours with the given masks.
#include "ngs/cut/contours/refined_masks.h"

#include <doctest/doctest.h>

#include <algorithm>

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
    some[v].rendered_biou = 0.5, some[v].refined_biou = 0.5 + gain + (v % 2 == 0 ? 0.002 : -0.002);
    some[v].own_contrast = contrast, some[v].refined_contrast = 1;
    some[v].beyond_px2 = beyond_px2, some[v].short_px2 = short_px2;
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
  camera.width_px = 120, camera.height_px = 100;
  for (const double cx : {70.5, 9.0}) {  // inside the image, and cut by its edge
    CAPTURE(cx);
    camera.cx = cx, camera.cy = 41;
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
      a.push_back(mask_is_foreground(target[p])), b.push_back(mask_is_foreground(masks.target[0][p]));
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

}  // namespace ngs
