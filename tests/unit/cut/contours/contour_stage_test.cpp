#include "ngs/cut/contours/contour_stage.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <stdexcept>

#include "ngs/cut/contours/refined_masks.h"
#include "ngs/cut/methods/method_flash.h"
#include "ngs/ops/image/metrics.h"
#include "ngs/ops/image/pixel_window.h"
#include "ngs/render/render_stage.h"
#include "support/joint_case.h"
#include "support/switches.h"

namespace ngs {
namespace {

struct ContourCase {
  std::unique_ptr<test::JointCase> base = test::joint_case();
  ContourOptions contour;
  JointOptions joint;
  SampleOptions sample;
  RbfOptions rbf;

  ContourCase() {
    contour.epochs = 5;
    contour.margin_px = 6;
    contour.refine.reach_px = 8;
    contour.refine.band_px = 3;
    // The model's ball is too large: its contour lies outside the photos' contour.
    for (std::size_t i = 0; i < base->is_ball.size(); ++i)
      if (base->is_ball[i] > 0)
        for (std::size_t k = 0; k < 3; ++k) base->model.log_scale[i * 3 + k] += 0.35f;
  }
  Problem input() const {
    Problem in = base->input();
    in.load_fine_photo = in.load_photo;
    return in;
  }
  Solution start(const Problem& in) const { return run_flash({}, test::Quiet(), {}, in); }
  Solution run(const Problem& in, int threads = 1) const {
    return refine_contours({.threads = threads}, test::Quiet(), {contour, {joint, sample, rbf}, in, {}}, start(in));
  }
  double mean_biou(const Solution& result) const {
    double sum = 0;
    for (std::size_t v = 0; v < 4; ++v) {
      const RenderedView r = render_labelled({}, {*result.cloud, result.labels}, base->scene.views[v].camera, {});
      std::vector<std::uint8_t> a, b;
      for (std::size_t p = 0; p < r.label.data.size(); ++p) {
        a.push_back(r.label.data[p] > 0.5f);
        b.push_back(base->masks[v].target[0][p] > 0.5f);
      }
      sum += score_mask({}, {a.data(), 48, 40}, {b.data(), 48, 40}).biou_1px / 4;
    }
    return sum;
  }
};

TEST_CASE("contours that are misaligned with the photos' edges move to the edges") {
  ContourCase c;
  c.contour.on = test::contours_switched({"contour-iterations=on"});
  const Problem in = c.input();
  const Solution before = c.start(in), after = c.run(in);
  CHECK(after.figures.at("contour_iterations") == 2);
  CHECK(after.figures.at("contour_biou_refined") >= after.figures.at("contour_biou_rendered"));
  MESSAGE("boundary IoU of 1 px: " << c.mean_biou(before) << " -> " << c.mean_biou(after));
  CHECK(c.mean_biou(after) > c.mean_biou(before) + 0.1);
  REQUIRE(std::int64_t(after.source_row.size()) == after.cloud->size());
  CHECK(after.cloud->size() > before.cloud->size());
  for (const std::int64_t row : after.source_row) CHECK((row >= 0 && row < before.cloud->size()));
  for (const auto* values : {&after.cloud->position, &after.cloud->log_scale})
    for (const float x : *values) REQUIRE(std::isfinite(x));
  for (const float x : after.labels[0].label) REQUIRE(std::isfinite(x));
}

TEST_CASE("contours at half the size move to the edges of photos of the camera's size, and read no finer ones") {
  ContourCase c;
  Problem in = c.input();
  in.load_fine_photo = [](std::size_t) -> ImageF { throw std::logic_error("reads the fine photo"); };
  std::vector<int> photos(4);
  in.load_photo = [&photos, load = in.load_photo](std::size_t view) { return ++photos.at(view), load(view); };
  const Solution before = c.start(in);
  ContourSetup setup{c.contour, {c.joint, c.sample, c.rbf}, in};
  setup.half_size = true;
  const Solution after = refine_contours({}, test::Quiet(), setup, before);
  CHECK(after.figures.at("contour_iterations") == 2);
  CHECK(*std::ranges::min_element(photos) > 0);
  MESSAGE("boundary IoU of 1 px: " << c.mean_biou(before) << " -> " << c.mean_biou(after));
  CHECK(c.mean_biou(after) > c.mean_biou(before) + 0.05);
}

TEST_CASE("contours at half of an odd size lie where those at half of the even size do") {
  const auto mean_x_px = [](int width_px) {
    ContourCase c;
    const PixelWindow part{0, 0, width_px, 40};
    const std::vector<SceneView> whole = c.base->scene.views;
    for (SceneView& view : c.base->scene.views) view.camera = window_camera(view.camera, part);
    Problem in = c.input();
    in.load_photo = [part, load = in.load_photo](std::size_t v) {
      const ImageF photo = load(v);
      ImageF out(part.w, part.h, photo.channels);
      out.data = cropped(photo.data, photo.width_px, photo.channels, part);
      return out;
    };
    in.load_masks = [part, load = in.load_masks](std::size_t v) { return cropped(load(v), part); };
    ContourSetup setup{c.contour, {c.joint, c.sample, c.rbf}, in};
    setup.half_size = true;
    const Solution after = refine_contours({}, test::Quiet(), setup, c.start(in));
    REQUIRE(after.figures.at("contour_iterations") == 2);
    double sum = 0, count = 0;
    for (const SceneView& view : whole) {
      const RenderedView r = render_labelled({}, {*after.cloud, after.labels}, view.camera, {});
      for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 48; ++x) {
          sum += x * double(r.label.at(x, y));
          count += double(r.label.at(x, y));
        }
    }
    return sum / count;
  };
  const double even_px = mean_x_px(48), odd_px = mean_x_px(47);
  MESSAGE("mean column of the object: " << even_px << ", " << odd_px);
  CHECK(std::abs(even_px - odd_px) < 0.1);
}

TEST_CASE("contours: small photos are enlarged only if that improves the agreement with the masks") {
  ContourCase c;
  c.base = test::joint_case();  // contours match the masks
  c.contour.refine.reach_px = 16;
  const Problem in = c.input();
  const Solution start = c.start(in), after = c.run(in);
  const auto refined = [&](int detail) {
    return refine_views({}, {c.contour.refine, c.contour.margin_px, in, detail}, {*start.cloud, start.labels}, in.views,
                        in.views);
  };
  const std::vector<RefinedView> small = refined(1), large = refined(2);
  CHECK(could_enlarge(small, 2));
  CHECK(!could_enlarge(small, 1));
  for (const double gain : gains_over(large, small)) CHECK(gain > 0.01);
  CHECK(std::abs(large[0].window.w - small[0].window.w) <= 2);  // both at the camera's size
  CHECK(after.figures.at("contour_detail") == 2);
  CHECK(after.figures.at("contour_biou_refined") > 0.72);  // small: 0.68
  const ContourCase too_large;
  CHECK(too_large.run(too_large.input()).figures.at("contour_detail") == 1);
}

TEST_CASE("contours: in an enlarged photo a contour moves by the same share of the image as in the photo") {
  ContourCase c;  // contours lie outside the photos' contours
  c.contour.refine.band_px = 1;
  const Problem in = c.input();
  const Solution start = c.start(in);
  const auto area_px = [&](int detail) {
    const std::vector<RefinedView> refined =
        refine_views({}, {c.contour.refine, c.contour.margin_px, in, detail}, {*start.cloud, start.labels}, {0}, {});
    const ViewMasks masks = refined[0].masks.unpacked();
    return std::accumulate(masks.target[0].begin(), masks.target[0].end(), 0.0);
  };
  c.contour.refine.shape_weight = 1e6;
  const double rendered_px = area_px(1);
  c.contour.refine.shape_weight = ContourOptions{}.refine.shape_weight;
  const double moved_px = rendered_px - area_px(1), moved_large_px = rendered_px - area_px(2);
  MESSAGE("area " << rendered_px << ", refined away " << moved_px << ", enlarged " << moved_large_px);
  CHECK(moved_px > 0.05 * rendered_px);
  CHECK(moved_large_px > 0.75 * moved_px);
}

TEST_CASE("contours: every iteration starts from the labels trained so far") {
  ContourCase c;
  c.joint.rate_label = 0;
  c.contour.on = test::contours_switched({"split=off"});
  const Problem in = c.input();
  Solution start = c.start(in);
  LabelColumn& trained = start.labels[0].prob;
  for (std::size_t i = 0; i < trained.size(); ++i) trained[i] = c.base->is_ball[i] > 0 ? 0.7f : 0.2f;
  const Solution after = refine_contours({}, test::Quiet(), {c.contour, {c.joint, c.sample, c.rbf}, in}, start);
  REQUIRE(after.figures.at("contour_iterations") > 0);
  REQUIRE(after.labels[0].prob.size() == trained.size());
  for (std::size_t i = 0; i < trained.size(); ++i) CHECK(std::abs(after.labels[0].prob[i] - trained[i]) < 1e-5f);
}

TEST_CASE("contours: photos of held-out views are read, their masks never") {
  const ContourCase c;
  Problem in = c.input();
  in.views = {0, 1, 3};
  std::set<std::size_t> masks, photos;  // run() uses one thread
  in.load_masks = [&, inner = in.load_masks](std::size_t v) { return masks.insert(v), inner(v); };
  in.load_fine_photo = [&, inner = in.load_fine_photo](std::size_t v) { return photos.insert(v), inner(v); };
  ContourCase only_train;
  only_train.contour.views = ContourViews::kTrain;
  c.run(in);
  CHECK(masks == std::set<std::size_t>{0, 1, 3});
  CHECK(photos == std::set<std::size_t>{0, 1, 2, 3});
  photos.clear();
  only_train.run(in);
  CHECK(photos == std::set<std::size_t>{0, 1, 3});
}

TEST_CASE("contours: the rendering outside the trained windows hardly changes") {
  ContourCase c;
  const Problem in = c.input();
  const Solution before = c.start(in), after = c.run(in);
  double worst = 0;
  for (std::size_t v = 0; v < 4; ++v) {
    RenderRequest request;
    const Camera& camera = c.base->scene.views[v].camera;
    const RenderedView a = render({}, *before.cloud, camera, {}, request),
                       b = render({}, *after.cloud, camera, {}, request);
    for (int x = 0; x < 48; ++x)  // the first and the last row lie outside all windows
      for (const int y : {0, 39})
        for (int k = 0; k < 3; ++k)
          worst = std::max(worst, double(std::abs(a.colour.at(x, y, k) - b.colour.at(x, y, k))));
  }
  MESSAGE("largest change of a colour outside: " << worst);
  CHECK(worst < 0.02);
}

TEST_CASE("contours: Gaussians that are visible in no window have no influence and do not change") {
  ContourCase plain, crowded;
  crowded.contour.on = plain.contour.on = test::contours_switched({"contour-iterations=on"});
  GaussianCloud& cloud = crowded.base->model;
  const std::int64_t n = cloud.size(), more = 40;
  cloud.resize(n + more, cloud.sh_degree);
  for (std::int64_t i = n; i < n + more; ++i) {  // behind the cameras, or far outside their views
    cloud.position[std::size_t(i) * 3] = i % 2 == 0 ? 0.1f * float(i - n) : 40;
    cloud.position[std::size_t(i) * 3 + 2] = i % 2 == 0 ? -3 : 5;
    cloud.rotation[std::size_t(i) * 4] = 1;
    cloud.logit_opacity[std::size_t(i)] = 2;
  }
  for (const auto column : kLabelColumns) (crowded.base->labels[0].*column).resize(std::size_t(n + more));
  const Solution want = plain.run(plain.input()), got = crowded.run(crowded.input());
  CHECK(want.figures.at("contour_iterations") == 2);
  REQUIRE(got.cloud->size() == want.cloud->size() + more);
  std::size_t at = 0;
  int moved = 0;
  for (std::size_t i = 0; i < std::size_t(got.cloud->size()); ++i) {
    const auto source = got.source_row[i];
    const bool added = source >= n;
    moved += got.cloud->position[i * 3] != cloud.position[std::size_t(source) * 3];
    const GaussianCloud& from = added ? cloud : *want.cloud;
    const std::size_t row = added ? std::size_t(source) : at++;
    for (std::size_t a = 0; a < 3; ++a) {
      REQUIRE(got.cloud->position[i * 3 + a] == from.position[row * 3 + a]);
      REQUIRE(got.cloud->log_scale[i * 3 + a] == from.log_scale[row * 3 + a]);
      REQUIRE(got.cloud->sh_dc[i * 3 + a] == from.sh_dc[row * 3 + a]);
    }
    REQUIRE(got.labels[0].prob[i] == (added ? 0.f : want.labels[0].prob[row]));
  }
  CHECK(moved > 100);
}

TEST_CASE("contours: the callback after a step gets the whole model, not only the trained rows") {
  const ContourCase c;
  const Problem in = c.input();
  std::int64_t calls = 0, whole_rows = 0;
  const Solution result =
      refine_contours({}, test::Quiet(),
                      {c.contour,
                       {c.joint, c.sample, c.rbf},
                       in,
                       [&](const JointProgress&, JointTrainer& trainer, const std::function<Solution()>& whole) {
                         const Solution now = whole();
                         ++calls;
                         whole_rows = now.cloud->size();
                         CHECK(now.labels[0].prob.size() == std::size_t(now.cloud->size()));
                         CHECK(trainer.result().cloud->size() <= now.cloud->size());
                         return calls == 3;
                       }},
                      c.start(in));
  CHECK(calls == 3);
  CHECK(whole_rows == result.cloud->size());
  CHECK_FALSE(result.converged);
}

TEST_CASE("contours: the caller gets the number of iterations before the first step") {
  ContourCase c;
  c.contour.on = test::contours_switched({"contour-iterations=on"});
  const Problem in = c.input();
  std::vector<int> calls;  // 0: a step
  ContourSetup setup{c.contour, {c.joint, c.sample, c.rbf}, in};
  setup.stop_after = [&](const auto&, JointTrainer&, const auto&) { return calls.push_back(0), false; };
  setup.planned = [&](int iterations) { calls.push_back(iterations); };
  refine_contours({}, test::Quiet(), setup, c.start(in));
  CHECK(calls.at(0) == 2);
  CHECK(std::ranges::count(calls, 2) == 1);
}

TEST_CASE("contours: halves from an earlier stage keep the labels of their parents that a hand edit fixed") {
  ContourCase c;
  Problem in = c.input();
  const Solution first = c.run(in);
  in.fixed.assign(std::size_t(in.cloud.size()), 0.f);
  for (std::size_t i = 0; i < first.source_row.size(); ++i) {
    const bool is_half = std::ranges::count(first.source_row, first.source_row[i]) == 2;
    if (is_half) in.fixed[std::size_t(first.source_row[i])] = 1;
  }
  Solution start = first;
  for (std::size_t i = 0; i < first.source_row.size(); ++i)
    if (in.fixed[std::size_t(first.source_row[i])] > 0)
      start.labels[0].label[i] = start.labels[0].prob[i] = float(i % 2);
  c.contour.on = test::contours_switched({"split=off"});
  const Solution after = refine_contours({}, test::Quiet(), {c.contour, {c.joint, c.sample, c.rbf}, in}, start);
  REQUIRE(after.figures.at("contour_iterations") > 0);
  REQUIRE(after.source_row == first.source_row);
  int fixed = 0;
  for (std::size_t i = 0; i < after.source_row.size(); ++i)
    if (in.fixed[std::size_t(after.source_row[i])] > 0) {
      ++fixed;
      CHECK(std::abs(after.labels[0].prob[i] - start.labels[0].prob[i]) < 0.01f);
    }
  CHECK(fixed > 10);
}

TEST_CASE("contours: all iterations but the last may train at half the size") {
  ContourCase c;
  const Problem in = c.input();
  const auto iterations = [&](int count, const char* entry) {
    c.contour.iterations = count;
    c.contour.on = test::contours_switched({"contour-iterations=on", entry});
    return c.run(in);
  };
  CHECK(iterations(1, "full-resolution=off").cloud->position == iterations(1, "full-resolution=on").cloud->position);
  const Solution fine = iterations(2, "full-resolution=on"), early_coarse = iterations(2, "full-resolution=off");
  CHECK(early_coarse.cloud->position != fine.cloud->position);
  const double before = c.mean_biou(c.start(in));
  MESSAGE("boundary IoU of 1 px: " << before << ", fine " << c.mean_biou(fine) << ", early iteration coarse "
                                   << c.mean_biou(early_coarse));
  CHECK(c.mean_biou(early_coarse) > before + 0.1);
  CHECK(c.mean_biou(early_coarse) > c.mean_biou(fine) - 0.05);
}

TEST_CASE("contours: iterations at half the size have half of the epochs, the last has all of them") {
  ContourCase c;
  c.contour.iterations = 2;
  const Problem in = c.input();
  const auto steps_with = [&](const char* entry) {
    c.contour.on = test::contours_switched({"contour-iterations=on", entry});
    std::vector<std::int64_t> steps;
    const auto note = [&](const JointProgress& progress, JointTrainer&, const std::function<Solution()>&) {
      if (progress.step == 1) steps.push_back(progress.steps);
      return false;
    };
    refine_contours({}, test::Quiet(), {c.contour, {c.joint, c.sample, c.rbf}, in, note}, c.start(in));
    return steps;
  };
  CHECK(steps_with("full-resolution=on") == std::vector<std::int64_t>{20, 20});
  CHECK(steps_with("full-resolution=off") == std::vector<std::int64_t>{12, 20});
}

TEST_CASE("contours: the result does not depend on the number of threads") {
  ContourCase c;
  c.contour.on = test::contours_switched({"contour-iterations=on", "full-resolution=off"});
  const Problem in = c.input();
  const Solution one = c.run(in, 1), three = c.run(in, 3);
  CHECK(one.cloud->position == three.cloud->position);
  CHECK(one.cloud->logit_opacity == three.cloud->logit_opacity);
  CHECK(one.labels[0].label == three.labels[0].label);
  CHECK(one.source_row == three.source_row);
}

TEST_CASE("contours: the model does not change if the given masks reject the refined ones") {
  ContourCase c;
  c.base = test::joint_case();  // contours match the masks
  Problem in = c.input();
  // Photos of another scene, with many edges that are no contours of the masks.
  in.load_fine_photo = [&](std::size_t) {
    ImageF photo(48, 40, 3);
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 48; ++x)
        for (int k = 0; k < 3; ++k) photo.at(x, y, k) = (x + y) % 6 < 3 ? 0.9f : 0.1f;
    return photo;
  };
  const Solution before = c.start(in), after = c.run(in);
  CHECK(after.figures.at("contour_iterations") == 0);
  CHECK(after.figures.at("contour_biou_refined") < after.figures.at("contour_biou_rendered"));
  CHECK(after.cloud->position == before.cloud->position);
  CHECK(after.labels[0].label == before.labels[0].label);
}

TEST_CASE("contours: masks that are all too small do not reject refinement") {
  ContourCase c;
  c.base = test::joint_case();
  for (std::size_t i = 0; i < c.base->is_ball.size(); ++i)  // the rendered masks are as small
    if (c.base->is_ball[i] > 0)
      for (std::size_t k = 0; k < 3; ++k) c.base->model.log_scale[i * 3 + k] -= 0.6f;
  for (ViewMasks& masks : c.base->masks) {  // erode by one pixel
    const std::vector<float> whole = masks.target[0];
    const int w = masks.width_px;
    for (int y = 1; y < masks.height_px - 1; ++y)
      for (int x = 1; x < w - 1; ++x)
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) {
            float& here = masks.target[0][std::size_t(y * w + x)];
            here = std::min(here, whole[std::size_t((y + dy) * w + x + dx)]);
          }
  }
  const Problem in = c.input();
  const Solution after = c.run(in);
  CHECK(after.figures.at("contour_biou_refined") < after.figures.at("contour_biou_rendered"));
  MESSAGE("agreement " << after.figures.at("contour_biou_rendered") << " -> "
                       << after.figures.at("contour_biou_refined") << ", contrast "
                       << after.figures.at("contour_contrast_given") << " of "
                       << after.figures.at("contour_contrast_refined"));
  CHECK(after.figures.at("contour_contrast_given") < 0.75 * after.figures.at("contour_contrast_refined"));
  CHECK(after.figures.at("contour_iterations") == 3);  // two for masks on edges
  c.contour.iterations = 1;
  CHECK(c.run(in).figures.at("contour_iterations") == 1);
}

TEST_CASE(
    "contours: no change without photos and without labels; an unreadable photo is an error; a draft has one "
    "iteration") {
  ContourCase c;
  Problem in = c.input();
  const Solution before = c.start(in);
  const auto unchanged = [&](const Problem& input) { CHECK(c.run(input).cloud->position == before.cloud->position); };
  Problem no_photo = in;
  no_photo.load_fine_photo = [](std::size_t) { return ImageF(); };
  unchanged(no_photo);
  no_photo.load_fine_photo = {};
  unchanged(no_photo);
  Problem no_label = in;
  std::vector<LabelColumns> none = in.labels;
  none[0].prob.assign(none[0].prob.size(), 0.f);
  no_label.labels = none;
  unchanged(no_label);
  Problem broken = in;
  broken.load_fine_photo = [](std::size_t) -> ImageF { throw Error(ErrorCode::kBadInput, "photo: broken", ""); };
  CHECK_THROWS_AS(c.run(broken, 2), Error);
  c.contour = {};
  c.joint.quality = Quality::kDraft;
  CHECK(c.run(in).figures.at("contour_iterations") == 1);
}

TEST_CASE("joint options: no epochs if contour iterations at half the size follow") {
  JointOptions joint;
  CHECK(epochs_of(joint) == 10);
  joint.coarse_contours_follow = true;
  CHECK(epochs_of(joint) == 0);
}

TEST_CASE("contours: more views give fewer epochs, higher qualities more iterations, and options override both") {
  CHECK((contour_iterations({}, Quality::kStandard, false) == 2 &&
         contour_iterations({}, Quality::kStandard, true) == 3));
  CHECK((contour_iterations({}, Quality::kHigh, true) == 5 && contour_iterations({}, Quality::kReference, false) == 7));
  CHECK(contour_epochs({}, Quality::kStandard, 1) == 15);
  CHECK(contour_epochs({}, Quality::kStandard, 12) == 15);
  CHECK(contour_epochs({}, Quality::kStandard, 16) == 14);
  CHECK(contour_epochs({}, Quality::kStandard, 21) == 10);
  CHECK(contour_epochs({}, Quality::kReference, 21) == 15);
  CHECK(contour_epochs({}, Quality::kStandard, 34) == 8);
  CHECK(contour_epochs({}, Quality::kStandard, 84) == 5);  // half, rounded up
  CHECK(contour_epochs({}, Quality::kStandard, 2100) == 1);
  CHECK(contour_epochs({}, Quality::kStandard, 100000) == 1);
  CHECK(contour_epochs({}, Quality::kDraft, 12) == 7);
  CHECK((contour_epochs({}, Quality::kDraft, 21) == 4 && contour_epochs({}, Quality::kDraft, 1000) == 1));
  CHECK((contour_iterations({}, Quality::kDraft, false) == 1 && contour_iterations({}, Quality::kDraft, true) == 2));
  ContourOptions given{.iterations = 4, .epochs = 7, .refine = {}, .on = {}};
  CHECK(contour_iterations(given, Quality::kReference, true) == 4);
  CHECK(contour_epochs(given, Quality::kDraft, 1000) == 7);
  CHECK(early_epochs(15) == 8);
  CHECK(early_epochs(1) == 1);
}

}  // namespace
}  // namespace ngs
