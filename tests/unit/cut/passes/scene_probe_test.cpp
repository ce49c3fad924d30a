// Tests each heuristic that reads images on a case in which the naive measure that it replaces decides wrongly.
// Heuristics that read columns only: scene_measures_test.cpp.
#include "ngs/cut/training/scene_probe.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "ngs/cut/contours/unexplained_contrast.h"
#include "ngs/cut/passes/mask_outliers/mask_outliers.h"
#include "ngs/cut/passes/pass_list.h"
#include "ngs/cut/passes/pipeline.h"
#include "ngs/ops/image/mask_pair.h"
#include "ngs/problem/scene_measures.h"
#include "ngs/render/render_stage.h"
#include "support/joint_case.h"

namespace ngs {
namespace {

struct ProbeCase {
  std::unique_ptr<test::JointCase> base = test::joint_case();
  std::vector<std::size_t> views{0, 1, 2, 3};

  ProbeCase() {
    for (SceneView& v : base->scene.views) v.image_path = "photo";
  }
  /// The value that the heuristic of an effect measures.
  double measure(std::string_view effect) const {
    Problem in = base->input();
    in.views = views;
    const TrainingOptions training;
    SceneProbe probe({}, training, in);
    const std::vector<Effect> effects = Pipeline(all_passes()).effects();
    const Heuristic& heuristic = find_effect(effects, effect)->heuristic;
    return heuristic.possible && !heuristic.possible(in) ? 0 : heuristic.measure(probe);  // like Decisions::decide()
  }
};

double threshold_of(std::string_view effect) {
  const std::vector<Effect> effects = Pipeline(all_passes()).effects();
  return find_effect(effects, effect)->heuristic.threshold;
}

/// Makes row `i` a small Gaussian at (x, y, z). The ball has radius 0.6 about (0, 0, 4); cameras are near the origin.
void hang(GaussianCloud& cloud, std::size_t i, float x, float y, float z) {
  cloud.position[3 * i] = x;
  cloud.position[3 * i + 1] = y;
  cloud.position[3 * i + 2] = z;
  for (std::size_t a = 0; a < 3; ++a) cloud.log_scale[3 * i + a] = -3.5f;
  cloud.logit_opacity[i] = 4;
}

/// The naive measure: the number of Gaussians nearer to the cameras than the ball.
int nearer_than_the_ball(const GaussianCloud& cloud) {
  int count = 0;
  for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i) count += cloud.position[3 * i + 2] < 3.3f;
  return count;
}

}  // namespace

TEST_CASE("mask outliers: views that do not see the object do not make an error common to the others an outlier") {
  ProbeCase c;
  for (std::size_t v = 0; v < 4; ++v) {  // every mask is shifted by 2 px, left or right
    std::vector<float>& mask = c.base->masks[v].target[0];
    std::rotate(mask.begin(), v % 2 == 0 ? mask.begin() + 2 : mask.end() - 2, mask.end());
  }
  const double few = c.measure("mask-outliers");
  CHECK(few <= threshold_of("mask-outliers"));
  for (int more = 0; more < 20; ++more) c.views.push_back(c.base->add_empty_view());  // naive: the median is zero
  CHECK(c.measure("mask-outliers") == few);
}

TEST_CASE("mask outliers: with several objects, the better of modal and amodal is chosen per view for all objects") {
  ProbeCase c;
  constexpr std::size_t kObjects = 3;
  hang(c.base->model, 160, 0, 0.1f, 2.6f);  // in front of the ball
  for (std::size_t a = 0; a < 3; ++a) c.base->model.log_scale[3 * 160 + a] = -1.8f;
  c.base->scene.objects = {{"top", 0}, {"middle", 1}, {"bottom", 2}};
  c.base->labels.assign(kObjects, c.base->labels[0]);
  for (std::size_t k = 0; k < kObjects; ++k)
    for (std::size_t i = 0; i < c.base->is_ball.size(); ++i)
      c.base->labels[k].label[i] = c.base->is_ball[i] != 0 && i * kObjects / 160 == k ? 1.f : 0.f;
  const Problem in = c.base->input();
  std::vector<double> better;
  int modal_is_better = 0, alone_is_better = 0;
  for (std::size_t v = 0; v < 4; ++v) {
    const Camera& camera = c.base->scene.views[v].camera;
    RenderedView view = render_labelled({}, {in.cloud, in.labels}, camera, {});
    ViewMasks& masks = c.base->masks[v];
    masks.target.assign(kObjects, std::vector<float>(std::size_t(view.label.pixels())));
    const ImageF modal_label = view.label;
    if (v % 2 == 1) show_objects_alone({}, {in.cloud, in.labels}, camera, {}, view);
    for (std::size_t k = 0; k < kObjects; ++k) {
      for (std::size_t p = 0; p < masks.target[k].size(); ++p)
        masks.target[k][p] = view.label.data[p * kObjects + k] > 0.5f ? 1.f : 0.f;
      const auto shift = std::ptrdiff_t(v + k);
      std::rotate(masks.target[k].begin(), masks.target[k].begin() + shift, masks.target[k].end());
    }
    show_objects_alone({}, {in.cloud, in.labels}, camera, {}, view);
    double modal = 0, alone = 0;
    for (std::size_t k = 0; k < kObjects; ++k) {
      modal += disagreement(MaskPair(modal_label, masks, k, foreground_boxes(modal_label)[k]).counts({}));
      alone += disagreement(MaskPair(view.label, masks, k, foreground_boxes(view.label)[k]).counts({}));
    }
    modal_is_better += modal < alone;
    alone_is_better += alone < modal;
    better.push_back(std::min(modal, alone) / double(kObjects));
  }
  CHECK(modal_is_better > 0);
  CHECK(alone_is_better > 0);
  CHECK(c.measure("mask-outliers") == doctest::Approx(outlier_score(better)).epsilon(1e-12));
}

TEST_CASE("exposure: a camera turned to a dark wall has the same exposure, a stopped-down camera does not") {
  ProbeCase turned, stopped;
  const auto mean = [](const ImageF& photo) {
    double sum = 0;
    for (const float x : photo.data) sum += double(x);
    return sum / double(photo.data.size());
  };
  for (ProbeCase* c : {&turned, &stopped}) {
    if (c == &turned) c->base->scene.views[1].camera.cx -= 30;
    for (std::size_t v = 0; v < 4; ++v)
      c->base->photos[v] = render({}, c->base->model, c->base->scene.views[v].camera, {}, {}).colour;
  }
  for (float& x : stopped.base->photos[1].data) x *= 0.95f;
  const auto ratio = [&](const ProbeCase& c) { return mean(c.base->photos[1]) / mean(c.base->photos[2]); };
  CHECK(ratio(turned) < ratio(stopped));  // naive: photos darker than others
  CHECK(turned.measure("exposure") <= threshold_of("exposure"));
  CHECK(stopped.measure("exposure") > threshold_of("exposure"));
}

TEST_CASE("components: an arm seen by one view is connected to the ball, a small Gaussian behind it is not") {
  ProbeCase arm, speck;
  for (ProbeCase* c : {&arm, &speck}) {
    LabelColumns& ball = c->base->labels[0];
    for (std::size_t i = 0; i < c->base->is_ball.size(); ++i) {
      ball.prob[i] = c->base->is_ball[i];
      ball.views[i] = 16;
    }
  }
  const auto claim = [](ProbeCase& c, std::size_t i, float x, float z) {
    hang(c.base->model, i, x, 0, z);
    c.base->labels[0].prob[i] = c.base->labels[0].views[i] = 1;
  };
  for (std::size_t i = 0; i < 20; ++i) claim(arm, 160 + i, 0.6f + 0.2f * float(i), 4);
  claim(speck, 160, 0, 9);
  const auto far_and_uncertain = [](const ProbeCase& c) {  // naive: labelled, seen once, two radii away
    int count = 0;
    for (std::size_t i = 0; i < c.base->is_ball.size(); ++i)
      count += c.base->labels[0].prob[i] > 0.5f && c.base->labels[0].views[i] == 1 &&
               std::hypot(c.base->model.position[3 * i], c.base->model.position[3 * i + 2] - 4) > 1.2f;
    return count;
  };
  CHECK(far_and_uncertain(arm) == 16);
  CHECK(far_and_uncertain(speck) == 1);
  CHECK(arm.measure("components") <= threshold_of("components"));
  CHECK(speck.measure("components") > threshold_of("components"));
}

TEST_CASE("floaters: many Gaussians nearer than the object but not in front of it hide nothing, one in front does") {
  ProbeCase aside, before;
  for (std::size_t i = 160; i < 200; ++i) hang(aside.base->model, i, 0.02f * float(i) - 3.6f, 0.45f, 1.5f);
  hang(before.base->model, 160, 0, 0, 1.5f);
  CHECK(nearer_than_the_ball(aside.base->model) == 40);  // naive: a seventh of the model, search
  CHECK(nearer_than_the_ball(before.base->model) == 1);  // naive: one of 280, leave it
  CHECK(aside.measure("floaters") <= threshold_of("floaters"));
  CHECK(before.measure("floaters") > threshold_of("floaters"));
}

TEST_CASE("nerf without photos: contours that are wrong at a few pixels lower boundary IoU, hardly IoU") {
  ProbeCase c;
  for (SceneView& v : c.base->scene.views) v.image_path.clear();
  c.base->model = c.base->truth;
  c.base->labels[0].label = c.base->labels[0].prob = c.base->is_ball;  // renders exactly the masks
  // Naive: there is a boundary set, so the NeRF is on.
  CHECK(std::count(c.base->labels[0].boundary.begin(), c.base->labels[0].boundary.end(), 1.f) > 0);
  CHECK(c.measure("nerf") <= threshold_of("nerf"));
  double worst_iou_gap = 0;
  for (ViewMasks& m : c.base->masks) {
    auto& mask = m.target[0];
    const auto area = double(std::count(mask.begin(), mask.end(), 1.f));
    const std::vector<float> whole = mask;
    int cut = 0;
    for (std::size_t p = 1; p < mask.size() && cut < 3; ++p)  // left end of a row of the mask
      if (whole[p] > 0 && whole[p - 1] == 0) {
        mask[p] = 0;
        ++cut;
      }
    worst_iou_gap = std::max(worst_iou_gap, cut / area);
  }
  CHECK(worst_iou_gap < threshold_of("nerf"));  // naive: the IoU is high enough
  CHECK(c.measure("nerf") > threshold_of("nerf"));
  // A photo of one training view switches the NeRF off, whatever the masks; a photo of another view does not.
  c.base->scene.views[1].image_path = "photo";
  CHECK(c.measure("nerf") == 0);
  c.views = {0, 2, 3};
  CHECK(c.measure("nerf") > threshold_of("nerf"));
  // Without a boundary set the NeRF is off.
  c.base->labels[0].boundary.assign(c.base->labels[0].boundary.size(), 0.f);
  CHECK(c.measure("nerf") == 0);
}

TEST_CASE("photos: only photos of training views count, and one is enough") {
  ProbeCase c;
  c.views = {0, 1};
  c.base->scene.views[0].image_path.clear();
  c.base->scene.views[1].image_path.clear();
  // Naive: half of the scene's views have a photo.
  CHECK(c.measure("contours") <= threshold_of("photometric"));
  c.base->scene.views[1].image_path = "photo";
  c.views = {0, 1, 2, 3};
  for (std::size_t v = 2; v < 4; ++v) c.base->scene.views[v].image_path.clear();  // naive: most views have none
  CHECK(c.measure("contours") > threshold_of("contours"));
}

TEST_CASE("whole-photo: a view that does not show the object does not switch training on whole photos on") {
  ProbeCase c;
  const std::size_t last = c.base->is_ball.size() - 1;
  hang(c.base->model, last, 0, 0, -4);  // behind the cameras of the ball
  c.base->labels[0].label[last] = 1;
  c.views.push_back(c.base->add_empty_view());  // naive: all its pixels lie outside the window of its empty mask
  CHECK(c.measure("whole-photo") <= threshold_of("whole-photo"));
}

namespace {

/// The joint case with `views` views, copies of its four, and labels of the ball.
std::unique_ptr<test::JointCase> many_views(std::size_t views) {
  auto c = test::joint_case();
  for (std::size_t v = 4; v < views; ++v) {
    c->scene.views.push_back(c->scene.views[v % 4]);
    c->photos.push_back(c->photos[v % 4]);
    c->masks.push_back(c->masks[v % 4]);
  }
  for (SceneView& v : c->scene.views) v.image_path = "photo";
  c->labels[0].prob = c->labels[0].label = c->is_ball;
  return c;
}

/// The probe's gain; `loads`: number of photos with refined contours.
double edge_gain(test::JointCase& c, std::size_t& loads) {
  Problem in = c.input();
  loads = 0;
  in.load_fine_photo = [load = in.load_photo, &loads](std::size_t v) { return ++loads, load(v); };
  in.views.clear();
  for (std::size_t v = 0; v < c.scene.views.size(); ++v) in.views.push_back(v);
  const TrainingOptions training;
  return SceneProbe({}, training, in).edge_gain();
}

/// The gain without the test whether the model explains the photos.
double gain_of_masks(test::JointCase& c) {
  Problem in = c.input();
  in.load_fine_photo = in.load_photo;
  std::vector<std::size_t> all;
  for (std::size_t v = 0; v < c.scene.views.size(); ++v) all.push_back(v);
  return mask_agreement_gain(refine_views({}, {ContourRefineOptions{}, 0, in}, {c.model, c.labels}, all, all));
}

/// Darkens the core of the ball, which adds an edge inside the true contour. Refinement moves to that edge.
void darken_core(test::JointCase& c) {
  for (std::size_t v = 0; v < c.photos.size(); ++v) {
    ImageF& photo = c.photos[v];
    const std::vector<float>& mask = c.masks[v].target[0];
    for (int y = 1; y + 1 < photo.height_px; ++y)
      for (int x = 1; x + 1 < photo.width_px; ++x) {
        const auto in = [&](int dx, int dy) { return mask[std::size_t((y + dy) * photo.width_px + x + dx)] > 0.5f; };
        const bool core = in(0, 0) && in(1, 0) && in(-1, 0) && in(0, 1) && in(0, -1);
        for (int k = 0; k < 3; ++k) photo.at(x, y, k) = core ? 0.f : 1.f;
      }
  }
}

}  // namespace

TEST_CASE("edge gain: 0 if photos have edges that the model does not show, although the masks reject refinement") {
  const auto c = many_views(32);
  darken_core(*c);
  CHECK(gain_of_masks(*c) < -kSignificant);  // the masks alone would reject
  std::size_t loads = 0;
  CHECK(edge_gain(*c, loads) == 0);
  CHECK(loads == kPhotoViews);
}

TEST_CASE("edge gain: if the photos are renderings of the model the masks decide, for any number of views") {
  for (const std::size_t views : {4, 12, 31, 32}) {
    CAPTURE(views);
    const auto c = many_views(views);
    for (std::size_t v = 0; v < views; ++v) {
      RenderRequest request;
      c->photos[v] = render({}, c->model, c->scene.views[v].camera, {}, request).colour;
    }
    std::size_t loads = 0;
    const double gain = edge_gain(*c, loads);
    CHECK(gain != 0);
    CHECK(loads == (gain < -kClearScore ? std::min(views, kFirstComparedViews) : views));
    if (loads == views) CHECK(gain == gain_of_masks(*c));
  }
}

}  // namespace ngs
