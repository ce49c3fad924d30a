#include "ngs/cut/contours/photoless_views.h"

#include <doctest/doctest.h>

#include <numeric>

#include "ngs/backend/for_each.h"
#include "ngs/cut/contours/contour_stage.h"
#include "ngs/cut/methods/method_flash.h"
#include "ngs/render/render_stage.h"
#include "support/joint_case.h"
#include "support/switches.h"

namespace ngs {
namespace {

/// Seven cameras about the ball of support/joint_case.h, with a model that is too large. The last `unseen` views have
/// neither photo nor mask.
struct SevenViews {
  static constexpr int kViews = 7;
  std::unique_ptr<test::JointCase> base = test::joint_case();
  ContourOptions contour;
  JointOptions joint;
  std::size_t seen;

  explicit SevenViews(int unseen) : seen(std::size_t(kViews - unseen)) {
    contour.epochs = 3;
    contour.margin_px = 6;
    contour.refine.reach_px = 8;
    contour.refine.band_px = 3;
    for (int v = 4; v < kViews; ++v) {
      SceneView view = base->scene.views[0];
      Camera& camera = view.camera;
      camera.name = "view" + std::to_string(v) + ".png";
      const double angle = 0.12 * (v - 1.5);
      camera.rotation = {{std::cos(angle), 0, std::sin(angle), 0, 1, 0, -std::sin(angle), 0, std::cos(angle)}};
      camera.translation = {-4 * std::sin(angle), 0, 4 - 4 * std::cos(angle)};
      base->scene.views.push_back(view);
      RenderRequest request{.label = {base->is_ball.data(), base->truth.size(), 1}};
      const RenderedView truth = render({}, base->truth, camera, {}, request);
      base->photos.push_back(truth.colour);
      ViewMasks masks = base->masks[0];
      for (std::size_t p = 0; p < truth.label.data.size(); ++p)
        masks.target[0][p] = truth.label.data[p] > 0.5f ? 1.f : 0.f;
      base->masks.push_back(masks);
    }
    for (std::size_t i = 0; i < base->is_ball.size(); ++i)
      if (base->is_ball[i] > 0)
        for (std::size_t k = 0; k < 3; ++k) base->model.log_scale[i * 3 + k] += 0.35f;
  }
  Problem input() const {
    Problem in = base->input();
    in.views.resize(seen);
    std::iota(in.views.begin(), in.views.end(), std::size_t(0));
    in.load_photo = [this](std::size_t v) { return v < seen ? base->photos[v] : ImageF(); };
    in.load_fine_photo = in.load_photo;
    return in;
  }
  Solution run(PhotolessViews unseen, int threads = 1, int* planned = nullptr) {
    contour.photoless = unseen;
    return run(input(), threads, planned);
  }
  Solution run(const Problem& in, int threads = 1, int* planned = nullptr) const {
    const auto plan = [&](int iterations) {
      if (planned != nullptr) *planned = iterations;
    };
    return refine_contours({.threads = threads}, test::Quiet(), {contour, {joint, {}, {}}, in, {}, plan},
                           run_flash({}, test::Quiet(), {}, in));
  }
};

bool same(const Solution& a, const Solution& b) {
  return a.cloud->position == b.cloud->position && a.cloud->log_scale == b.cloud->log_scale &&
         a.cloud->sh_dc == b.cloud->sh_dc && a.labels[0].label == b.labels[0].label && a.source_row == b.source_row;
}

TEST_CASE("photoless views: every third view is a trial view, none of fewer than five") {
  CHECK(trial_views_of({}).empty());
  CHECK(trial_views_of({0, 1, 2, 3}).empty());
  CHECK(trial_views_of({0, 2, 4, 6, 8}) == std::vector<std::size_t>{2, 8});
  CHECK(trial_views_of({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}) == std::vector<std::size_t>{1, 4, 7, 10});
}

TEST_CASE("photoless views: with_renderings replaces the photos of the given views by renderings over the background") {
  SevenViews c(2);
  Problem in = c.input();
  in.background = {0.2f, 0.4f, 0.6f};
  const Problem out = with_renderings({}, in, c.base->model, {1, 6});
  RenderRequest request{.label = {}, .background = in.background};
  for (const std::size_t v : {std::size_t(1), std::size_t(6)}) {
    const ImageF want = render({}, c.base->model, c.base->scene.views[v].camera, {}, request).colour;
    CHECK(out.load_photo(v).data == want.data);
    CHECK(out.load_fine_photo(v).data == want.data);
  }
  CHECK(out.load_photo(0).data == c.base->photos[0].data);
  CHECK(out.load_fine_photo(5).empty());
}

TEST_CASE("photoless views: renderings that do not fit into the cache are rendered again from a copy of the model") {
  SevenViews c(2);
  Problem in = c.input();
  in.background = {0.2f, 0.4f, 0.6f};
  std::vector<Problem> out;
  {
    const GaussianCloud temporary = c.base->model;
    const std::size_t one = 3 * sizeof(float) * 48 * 40;
    for (const std::size_t cache_bytes : {10 * one, one, std::size_t(0)})
      out.push_back(with_renderings({}, in, temporary, {1, 5, 6}, cache_bytes));
  }
  for (const std::size_t v : {1u, 5u, 6u})
    for (const Problem& pictured : {out[1], out[2]}) CHECK(pictured.load_photo(v).data == out[0].load_photo(v).data);
  const Exec exec{.threads = 3};
  std::vector<ImageF> at_once(6);
  for_each_task(exec, 6, [&](std::int64_t i) { at_once[std::size_t(i)] = out[2].load_fine_photo(5); });
  for (const ImageF& picture : at_once) CHECK(picture.data == out[0].load_fine_photo(5).data);
}

TEST_CASE("photoless views: renderings help if their contours are nearer to the photos' than those without the views") {
  SevenViews c(0);
  const Problem in = c.input();
  const std::vector<std::size_t> trial_views = trial_views_of(in.views);
  REQUIRE(trial_views.size() == 2);
  const std::vector<LabelColumns> labels = run_flash({}, test::Quiet(), {}, in).labels;
  const LabelledModel truth{c.base->truth, labels}, swollen{c.base->model, labels};
  const RefineSetup setup{c.contour.refine, c.contour.margin_px, in};
  const std::vector<RefinedView> in_photos = refine_views({}, setup, truth, in.views, {});
  const Trial good = evaluate_trial({}, setup, {truth, swollen}, in_photos, trial_views);
  const Trial bad = evaluate_trial({}, setup, {swollen, truth}, in_photos, trial_views);
  const Trial even = evaluate_trial({}, setup, {truth, truth}, in_photos, trial_views);
  MESSAGE("pictured, unseen: " << good.pictured << " " << good.skipped << "; " << bad.pictured << " " << bad.skipped
                               << "; " << even.pictured << " " << even.skipped);
  CHECK(good.renderings_help);
  CHECK(good.pictured > good.skipped + 0.1);
  CHECK_FALSE(bad.renderings_help);
  CHECK(bad.pictured < bad.skipped);
  CHECK(good.skipped < even.skipped);
}

TEST_CASE("photoless views: the trial decides whether renderings are used, and changes nothing else") {
  SevenViews c(2);
  int planned_leave = 0, planned_auto = 0;
  const Solution leave = c.run(PhotolessViews::kLeave, 1, &planned_leave), picture = c.run(PhotolessViews::kPicture),
                 decided = c.run(PhotolessViews::kAuto, 1, &planned_auto);
  CHECK(leave.figures.at("contour_pictures") == 0);
  CHECK(leave.figures.count("contour_biou_skipped") == 0);
  CHECK(picture.figures.at("contour_pictures") == 2);
  CHECK_FALSE(same(leave, picture));
  CHECK(decided.figures.at("contour_biou_pictured") > 0);
  CHECK(same(decided, decided.figures.at("contour_pictures") > 0 ? picture : leave));
  CHECK(decided.figures.at("contour_iterations") == leave.figures.at("contour_iterations"));
  CHECK(planned_auto == planned_leave + 1);  // the trial counts as an iteration
  CHECK(same(decided, c.run(PhotolessViews::kAuto, 3)));
}

TEST_CASE("photoless views: there is no trial for photos that windows leave out because they do not show the object") {
  SevenViews c(2);
  const Solution leave = c.run(PhotolessViews::kLeave);
  c.contour.photoless = PhotolessViews::kAuto;
  for (SceneView& view : c.base->scene.views) view.image_path = "photo.png";
  const Problem uncropped = c.input();
  Scene scene = c.base->scene;
  for (std::size_t v = c.seen; v < scene.views.size(); ++v) scene.views[v].image_path.clear();
  Problem cropped = uncropped.cropped(scene, uncropped.load_masks, uncropped.load_photo, {});
  cropped.load_fine_photo = [&c, load = uncropped.load_photo](std::size_t v) {
    CHECK(v < c.seen);
    return load(v);
  };
  cropped.uncropped = std::make_shared<const Problem>(uncropped);
  const Solution decided = c.run(cropped);
  CHECK(decided.figures.count("contour_biou_skipped") == 0);
  CHECK(same(decided, leave));
}

TEST_CASE("photoless views: a trial that is cut short counts as an iteration and reports no measurements") {
  SevenViews c(2);
  const Problem in = c.input();
  int steps = 0;
  const auto cut = [&](const JointProgress&, JointTrainer&, const std::function<Solution()>&) { return ++steps == 2; };
  const Solution result =
      refine_contours({}, test::Quiet(), {c.contour, {c.joint, {}, {}}, in, cut}, run_flash({}, test::Quiet(), {}, in));
  CHECK(steps == 2);
  CHECK_FALSE(result.converged);
  CHECK(result.figures.at("contour_iterations") == 1);
  CHECK(result.figures.count("contour_biou_pictured") == 0);
  CHECK(result.figures.count("contour_biou_skipped") == 0);
}

TEST_CASE("photoless views: there is no trial if every view has a photo, or with too few photos") {
  SevenViews all(0), few(3);
  const Solution leave = all.run(PhotolessViews::kLeave), decided = all.run(PhotolessViews::kAuto);
  CHECK(same(leave, decided));
  CHECK(same(leave, all.run(PhotolessViews::kPicture)));
  CHECK(decided.figures.count("contour_biou_skipped") == 0);
  CHECK(same(few.run(PhotolessViews::kLeave), few.run(PhotolessViews::kAuto)));
}

}  // namespace
}  // namespace ngs
