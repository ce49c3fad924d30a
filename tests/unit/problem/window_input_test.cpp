// A problem cropped to windows: crops have the pixels of the uncropped views, and passes give the same results.
#include "ngs/problem/window_input.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <optional>

#include "ngs/cut/evidence/method_labels.h"
#include "ngs/cut/passes/mask_outliers/mask_outliers.h"
#include "ngs/cut/training/joint_trainer.h"
#include "ngs/problem/region.h"
#include "support/joint_case.h"

namespace ngs {
namespace {

constexpr int kBall = 160;  // Gaussians; the others are the wall's

/// Pads a plane of `channels` interleaved channels by `by_px` on each side.
template <class T>
std::vector<T> larger(const std::vector<T>& plane, int w, int h, int channels, int by_px) {
  const int width_px = w + 2 * by_px, height_px = h + 2 * by_px;
  std::vector<T> out(std::size_t(width_px) * std::size_t(height_px) * std::size_t(channels));
  for (int y = 0; y < h; ++y)
    std::copy_n(plane.begin() + std::ptrdiff_t(y) * w * channels, w * channels,
                out.begin() + (std::ptrdiff_t(y + by_px) * width_px + by_px) * channels);
  return out;
}

/// The ball in large, mostly empty images; labels from the evidence of all pixels.
std::unique_ptr<test::JointCase> wide_case(int wall = 120) {
  constexpr int kBy_px = 64;
  std::unique_ptr<test::JointCase> c = test::joint_case(kBall, wall);
  for (std::size_t v = 0; v < c->scene.views.size(); ++v) {
    Camera& camera = c->scene.views[v].camera;
    ViewMasks& masks = c->masks[v];
    ImageF& photo = c->photos[v];
    for (std::vector<float>& target : masks.target)
      target = larger(target, camera.width_px, camera.height_px, 1, kBy_px);
    photo.data = larger(photo.data, camera.width_px, camera.height_px, 3, kBy_px);
    camera.width_px += 2 * kBy_px;
    camera.height_px += 2 * kBy_px;
    camera.cx += kBy_px;
    camera.cy += kBy_px;
    masks.width_px = photo.width_px = camera.width_px;
    masks.height_px = photo.height_px = camera.height_px;
  }
  const auto load = [&](std::size_t v) { return c->masks[v]; };
  const Evidence evidence = accumulate_evidence({}, test::Quiet(), {c->model, c->scene, {0, 1, 2, 3}, {}, load});
  c->labels = label_gaussians(c->rule, evidence);
  c->weight = std::make_shared<const std::vector<float>>(evidence.weights());
  return c;
}

struct WindowCase {
  std::unique_ptr<test::JointCase> base = wide_case();
  Problem whole = base->input();
  std::shared_ptr<const ObjectWindows> windows;
  std::optional<Problem> problem;  // cropped to the windows

  WindowCase() { enter(); }
  /// Crops the problem. `tight`: windows are the boxes of the masks, without margin.
  void enter(bool tight = false) {
    ObjectWindows found = object_windows({}, whole);
    for (std::size_t v = 0; tight && v < found.window.size(); ++v) {
      const ViewMasks masks = base->masks[v];
      found.window[v] = window_of(masks.target, masks.width_px, masks.height_px, 0);
    }
    windows = std::make_shared<const ObjectWindows>(std::move(found));
    const auto input = std::make_shared<const WindowInput>(whole, windows);
    problem.emplace(input->cropped());
    problem->uncropped = std::shared_ptr<const Problem>(input, &input->uncropped());
  }
};

}  // namespace

TEST_CASE("windows contain all pixels of the masks, are aligned to tiles, and have the photo and mask of that crop") {
  const WindowCase c;
  CHECK(c.windows->outside > 0.3);
  for (const std::size_t v : c.whole.views) {
    CAPTURE(v);
    const PixelWindow& w = c.windows->window[v];
    const Camera &whole = c.whole.scene.views[v].camera, &camera = c.problem->scene.views[v].camera;
    REQUIRE(w.w > 0);
    CHECK(w.x0 % 16 == 0);
    CHECK(w.y0 % 16 == 0);
    CHECK((camera.width_px == w.w && camera.height_px == w.h));
    CHECK((camera.cx == whole.cx - w.x0 && camera.cy == whole.cy - w.y0));
    const ViewMasks all = c.whole.load_masks(v), part = c.problem->load_masks(v);
    const auto sum = [](const std::vector<float>& plane) {
      double total = 0;
      for (const float x : plane) total += double(x);
      return total;
    };
    CHECK(sum(all.target[0]) > 0);
    CHECK(sum(part.target[0]) == sum(all.target[0]));
    const ImageF photo = c.whole.load_photo(v), crop = c.problem->load_photo(v);
    CHECK(crop.at(3, 5, 1) == photo.at(w.x0 + 3, w.y0 + 5, 1));
    CHECK(window_share(*c.problem, v) ==
          doctest::Approx(double(w.w) * w.h / (double(whole.width_px) * whole.height_px)));
  }
}

TEST_CASE("boxes of the masks give an upper bound on the share outside the windows, and lie inside the windows") {
  WindowCase c;
  const ObjectWindows masks = windows_of_masks({}, c.whole);
  CHECK(masks.outside >= c.windows->outside);
  CHECK(masks.outside < c.windows->outside + 0.2);  // margins count
  const ObjectWindows again = object_windows({}, c.whole, windows_of_masks({}, c.whole));
  CHECK(again.outside == c.windows->outside);
  for (const std::size_t v : c.whole.views) {
    CAPTURE(v);
    const PixelWindow &box = masks.window[v], &w = again.window[v], &want = c.windows->window[v];
    CHECK((w.x0 == want.x0 && w.y0 == want.y0 && w.w == want.w && w.h == want.h));
    CHECK((box.x0 > w.x0 && box.y0 > w.y0 && box.x0 + box.w < w.x0 + w.w && box.y0 + box.h < w.y0 + w.h));
  }
  c.base->labels[0].label.assign(c.base->labels[0].label.size(), 1.f);  // the wall is labelled too
  Problem wall = c.base->input();
  CHECK(windows_of_masks({}, wall).outside == masks.outside);
  CHECK(object_windows({}, wall).outside < c.windows->outside);
}

TEST_CASE("a view without a visible object has no window, is no training view and has no photo") {
  WindowCase c;
  const std::size_t away = c.base->add_empty_view();
  c.whole.views.push_back(away);
  c.enter();
  CHECK(c.windows->window[away].w == 0);
  CHECK(std::count(c.problem->views.begin(), c.problem->views.end(), away) == 0);
  CHECK(c.problem->views.size() == 4);
  CHECK(c.problem->scene.views[away].image_path.empty());
}

TEST_CASE("a view in which other Gaussians occlude the object has no window if its mask is empty") {
  const std::unique_ptr<test::JointCase> c = wide_case(1200);
  const std::size_t behind = c->add_empty_view();
  c->scene.views[behind].camera.translation.z += 13;  // the wall is between the camera and the ball
  for (std::size_t i = kBall; i < c->is_ball.size(); ++i) c->labels[0].label[i] = 0;  // the wall is background
  const auto window = [&] {
    Problem whole = c->input();
    whole.views.push_back(behind);
    return object_windows({}, whole).window;
  };
  CHECK(window()[behind].w == 0);
  CHECK(window()[0].w > 0);

  const std::size_t middle = std::size_t(c->scene.views[behind].camera.height_px / 2) *
                             std::size_t(c->scene.views[behind].camera.width_px + 1);
  c->masks[behind].target[0][middle] = 1;
  CHECK(window()[behind].w > 48);  // contains the mask pixel and the object
  c->masks[behind].target[0][middle] = 0;
  c->masks[behind].available = false;  // without a mask the occluder may be a floater
  CHECK(window()[behind].w > 0);
  c->masks[behind].available = true;
  for (std::size_t i = kBall; i < c->is_ball.size(); ++i) c->model.logit_opacity[i] = -6;  // a transparent wall
  CHECK(window()[behind].w > 0);
}

TEST_CASE("labels_without_views gives the labels of the other views' evidence") {
  WindowCase c;
  REQUIRE(c.problem->uncropped->weight != nullptr);
  const std::vector<LabelColumns> got = labels_without_views({}, test::Quiet(), *c.problem, {2});
  const std::vector<LabelColumns> want = label_gaussians(
      {}, accumulate_evidence({}, test::Quiet(),
                              {c.whole.cloud, c.whole.scene, {0, 1, 3}, c.whole.splat, c.whole.load_masks}));
  const std::vector<std::uint8_t> region = region_of(c.problem->labels);
  int compared = 0, moved = 0;
  for (std::size_t i = 0; i < region.size(); ++i) {
    if (!region[i]) continue;
    CHECK(std::abs(got[0].prob[i] - want[0].prob[i]) < 1e-5f);
    CHECK(got[0].label[i] == want[0].label[i]);
    ++compared;
    moved += want[0].prob[i] != c.problem->labels[0].prob[i];
  }
  CHECK(compared > 100);
  CHECK(moved > 10);  // the excluded view had an influence

  c.whole.weight = nullptr;  // a file without the weight
  c.enter();
  CHECK(labels_without_views({}, test::Quiet(), *c.problem, {})[0].prob ==
        recompute_labels({}, test::Quiet(), *c.problem, c.whole.cloud)[0].prob);
}

TEST_CASE("a Gaussian seen only by excluded views gets exact zeros") {
  WindowCase c;
  const std::vector<LabelColumns> got = labels_without_views({}, test::Quiet(), *c.problem, {0, 1, 2, 3});
  int claimed = 0;
  for (std::size_t i = 0; i < got[0].prob.size(); ++i) {
    if (!(c.problem->labels[0].prob[i] > 0.01f)) continue;
    ++claimed;
    CHECK(got[0].views[i] == 0);
    CHECK(got[0].prob[i] == 0);
    CHECK(got[0].label[i] == 0);
  }
  CHECK(claimed > 100);
}

TEST_CASE("mask outliers are the same in windows as in uncropped views") {
  for (const bool tight : {false, true}) {
    CAPTURE(tight);
    WindowCase c;
    const MaskOutliers whole = find_mask_outliers({}, test::Quiet(), c.whole);
    for (const bool known : {true, false}) {
      CAPTURE(known);
      if (!known) c.whole.weight = nullptr;
      c.enter(tight);
      const MaskOutliers windows = find_mask_outliers({}, test::Quiet(), *c.problem);
      CHECK(windows.ignored == whole.ignored);
      REQUIRE(windows.disagreement.size() == whole.disagreement.size());
      for (std::size_t n = 0; n < whole.disagreement.size(); ++n)
        CHECK(std::abs(windows.disagreement[n] - whole.disagreement[n]) < 0.01);
    }
  }
}

TEST_CASE("a step in windows equals the step in uncropped views, and rows outside the region keep their bytes") {
  WindowCase c;
  const std::vector<std::uint8_t> region = region_of(c.problem->labels);
  CHECK(std::count(region.begin(), region.end(), std::uint8_t(0)) > 20);
  const auto trained = [&](Problem problem, std::vector<std::uint8_t> rows) {
    problem.region = std::move(rows);
    Monitor monitor;
    JointOptions options;
    options.steps = 4;
    options.off = {"nerf", "photometric"};
    const SampleOptions sample;
    const RbfOptions rbf;
    JointTrainer trainer({}, monitor, {options, sample, rbf, problem}, true);
    while (!trainer.finished()) trainer.step();
    return trainer.result();
  };
  const Solution whole = trained(c.whole, region), windows = trained(*c.problem, region),
                 everything = trained(c.whole, {});
  const Solution every_row = trained(c.whole, std::vector<std::uint8_t>(region.size(), 1));
  CHECK(every_row.cloud->position == everything.cloud->position);
  CHECK(every_row.labels[0].prob == everything.labels[0].prob);
  std::int64_t outside = 0;
  for (std::size_t i = 0; i < region.size(); ++i) {
    const auto moved = [&](const Solution& s) {
      return std::abs(s.cloud->position[3 * i] - c.whole.cloud.position[3 * i]) +
             std::abs(s.cloud->logit_opacity[i] - c.whole.cloud.logit_opacity[i]);
    };
    if (!region[i]) {
      CHECK(moved(windows) == 0);
      CHECK(windows.labels[0].prob[i] == c.whole.labels[0].prob[i]);
      outside += moved(everything) > 0;
    }
    CHECK(std::abs(windows.labels[0].prob[i] - whole.labels[0].prob[i]) < 2e-3f);
  }
  CHECK(outside > 0);  // without a region these rows change
  CHECK(rows_changed(c.whole.cloud, c.whole.labels, windows) <= std::count(region.begin(), region.end(), 1));
  CHECK(rows_changed(c.whole.cloud, c.whole.labels, windows) > 50);
}

}  // namespace ngs
