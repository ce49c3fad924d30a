#include "ngs/cut/passes/bleed_through/bleed_through.h"

#include <doctest/doctest.h>

#include <atomic>

#include "ngs/cut/passes/pass.h"
#include "ngs/cut/passes/pass_list.h"
#include "ngs/math/stable.h"
#include "ngs/ops/splat/evidence.h"
#include "support/fake_clock.h"
#include "support/pipeline_case.h"
#include "support/splat_shapes.h"

namespace ngs {
namespace {

constexpr std::size_t kPane = 0, kTrace = 1;
constexpr float kAllPane = 0.85f;  // the Gaussian behind has a tenth of the weight

/// A semi-transparent pane, which is the object, and a small Gaussian behind it, which is background. Cameras in front
/// see the Gaussian faintly through the pane, within the mask; cameras behind see it unoccluded. The masks are correct.
struct Pane {
  GaussianCloud cloud;
  Scene scene;
  std::vector<ViewMasks> masks;
  std::vector<LabelColumns> labels;

  Pane(int before, int behind) {
    test::add_gaussian(cloud, {0, 0, 2}, {0.6, 0.6, 0.0067}, {}, logit(0.95));  // kPane
    test::add_gaussian(cloud, {0, 0, 3}, 0.15, {}, logit(0.9));                 // kTrace
    scene.objects = {{"pane", 0}};
    for (int v = 0; v < before; ++v) add_view(1, {-0.01 * v, 0.02 * v, 0});
    for (int v = 0; v < behind; ++v) add_view(-1, {0.01 * v, 0.03 * v, 20});
    labels.resize(1);
    for (const auto column : kLabelColumns) (labels[0].*column).assign(2, 0.f);
    labels[0].label = {1, 1};
    labels[0].prob = {0.95f, 0.6f};
  }

  void add_view(double forward, Vec3<double> translation) {
    Camera camera;
    camera.name = "view" + std::to_string(scene.views.size()) + ".png";
    camera.width_px = 64;
    camera.height_px = 48;
    camera.fx = camera.fy = 60;
    camera.cx = 32.5;
    camera.cy = 24;
    camera.rotation = {{forward, 0, 0, 0, 1, 0, 0, 0, forward}};
    camera.translation = translation;
    const float is_pane[] = {1, 0};
    ViewMasks mask{64, 48, {render({}, cloud, camera, {}, {.label = {is_pane, 2, 1}}).label.data}, {}, true};
    for (float& m : mask.target[0]) m = m > kAllPane;
    scene.views.push_back({camera, "", "", Split::kTrain});
    masks.push_back(std::move(mask));
  }

  Problem problem() const {
    Problem in{.cloud = cloud,
               .scene = scene,
               .load_masks = [this](std::size_t v) { return masks[v]; },
               .load_photo = [](std::size_t) { return ImageF(); },
               .labels = labels};
    for (std::size_t v = 0; v < scene.views.size(); ++v) in.views.push_back(v);
    return in;
  }
};

BleedThrough finding_of(const Problem& in, int threads = 1) {
  return without_bleed_through({.threads = threads}, in, in.labels);
}

}  // namespace

TEST_CASE("bleed through: a Gaussian behind the object loses its label, and nothing else changes") {
  const Pane pane(12, 12);
  const Problem in = pane.problem();
  const BleedThrough found = finding_of(in), threaded = finding_of(in, 3);
  REQUIRE(found.objects.size() == 1);
  CHECK(found.objects[0].found == 1);
  CHECK(found.objects[0].gain > 2);
  CHECK(found.objects[0].taken);
  CHECK(found.labels[0].label == LabelColumn({1, 0}));
  for (const auto column : kLabelColumns)
    if (column != &LabelColumns::label) CHECK(found.labels[0].*column == pane.labels[0].*column);
  CHECK(threaded.objects[0].gain == found.objects[0].gain);
}

// The closed form labels the Gaussian as object: most of its rendering weight is seen through the pane.
TEST_CASE("bleed through: with rendering weights the Gaussian behind the object would be labelled object") {
  const Pane pane(12, 12);
  double all = 0, objects = 0;
  for (std::size_t v = 0; v < pane.masks.size(); ++v) {
    const ViewSums sums = view_sums({}, pane.cloud, {pane.scene.views[v].camera, pane.masks[v]}, {});
    for (std::size_t s = 0; s < sums.size(); ++s)
      if (sums.row[s] == kTrace) {
        all += sums.weight(s);
        objects += sums.object_weight(s, 0);
      }
  }
  CHECK(objects / all > 0.5);
}

TEST_CASE("bleed through: labels stay if the masks do not improve, if they are certain or fixed, and without masks") {
  const Pane few(12, 2), pane(12, 12);
  const BleedThrough not_improved = finding_of(few.problem());
  CHECK(not_improved.objects[0].found == 1);
  CHECK_FALSE(not_improved.objects[0].taken);
  CHECK(not_improved.labels[0].label == few.labels[0].label);

  Pane certain = pane, dark = pane;
  certain.labels[0].prob[kTrace] = 0.85f;
  CHECK(finding_of(certain.problem()).objects[0].found == 0);
  for (ViewMasks& mask : dark.masks) mask.available = false;
  CHECK(finding_of(dark.problem()).objects[0].found == 0);
  Problem fixed = pane.problem(), blind = pane.problem();
  fixed.fixed = {0, 1};
  blind.views.clear();
  CHECK(finding_of(fixed).objects[0].found == 0);
  CHECK(finding_of(blind).objects[0].found == 0);
}

TEST_CASE("bleed through: two objects are tested separately") {
  Pane pane(12, 12);
  pane.scene.objects.push_back({"trace", 1});
  pane.labels.push_back(pane.labels[0]);
  pane.labels[0].label = {1, 0};
  pane.labels[1].label = {0, 1};
  for (ViewMasks& mask : pane.masks) mask.target.push_back(std::vector<float>(mask.target[0].size(), 0.f));
  const BleedThrough found = finding_of(pane.problem());  // all masks of the second object are empty
  CHECK(found.objects[0].found == 0);
  CHECK(found.objects[1].found == 1);
  CHECK(found.labels[0].label == pane.labels[0].label);
  CHECK(found.labels[1].label == LabelColumn({0, 0}));

  for (ViewMasks& mask : pane.masks)  // masks of the second object: the complement of the first's
    for (std::size_t p = 0; p < mask.target[0].size(); ++p) mask.target[1][p] = 1 - mask.target[0][p];
  CHECK(finding_of(pane.problem()).objects[1].found == 0);
}

TEST_CASE("bleed through: off without photos, and at draft quality") {
  const Pane pane(12, 12);
  const Problem in = pane.problem();
  TrainingOptions training;
  SceneProbe probe({}, training, in);
  const std::unique_ptr<Pass> pass = make_bleed_through_pass();
  const std::vector<Effect> effects = pass->effects();
  REQUIRE(effects.size() == 1);
  CHECK_FALSE(effects[0].heuristic.measure(probe) > effects[0].heuristic.threshold);  // 24 masks, no photo
  CHECK(pass->fixed_decisions(training).empty());
  training.joint.quality = Quality::kDraft;
  REQUIRE(pass->fixed_decisions(training).size() == 1);
  CHECK_FALSE(pass->fixed_decisions(training)[0].on);
}

TEST_CASE("bleed through: the pass changes the labels of a run, is aborted if too slow, but not with checkpoints") {
  const test::FakeClock clock;
  const Pane pane(12, 12);
  const Problem in = pane.problem();
  Problem slow = in;
  slow.load_masks = [&](std::size_t view) {
    clock.advance(0.01);
    return in.load_masks(view);
  };
  const auto bleed_through = [](test::PipelineCase& passes) -> PassRun& {
    passes.decisions().fix({"bleed-through", true, "the test"});
    return passes.run();
  };
  const std::vector<std::string> alone{"all=off", "bleed-through=auto"},
      trained{"all=off", "bleed-through=auto", "joint=on"};
  test::PipelineCase whole(in, {}, alone);
  CHECK(bleed_through(whole).solution->labels[0].label == LabelColumn({1, 0}));
  CHECK(whole.report()["bleed_through"]["gaussians"] == 1);
  CHECK(whole.report()["bleed_through"]["objects"][0]["object"] == "pane");

  test::PipelineCase late(slow, {}, alone);
  late.time_budget(0.1);
  CHECK(bleed_through(late).solution->labels[0].label == LabelColumn({1, 1}));
  CHECK_FALSE(late.decisions().on("bleed-through"));
  CHECK_FALSE(late.report().contains("bleed_through"));

  test::NullStepStore store;
  test::PipelineCase kept(slow, {}, trained);
  kept.time_budget(0.1);
  kept.store_steps(store);
  CHECK(bleed_through(kept).report["bleed_through"]["gaussians"] == 1);
}

TEST_CASE("bleed through: an interrupted search removes no label") {
  const Pane pane(12, 12);
  Monitor monitor;
  const std::atomic<bool> stop = true;
  monitor.stop_flag(&stop);
  Problem in = pane.problem();
  in.monitor = &monitor;
  const BleedThrough found = finding_of(in);
  CHECK_FALSE(found.objects[0].taken);
  CHECK(found.labels[0].label == pane.labels[0].label);
}

}  // namespace ngs
