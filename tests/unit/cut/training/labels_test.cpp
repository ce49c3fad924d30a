#include <doctest/doctest.h>

#include <cmath>

#include "ngs/cut/evidence/variance_stage.h"
#include "ngs/cut/training/joint_trainer.h"
#include "ngs/cut/training/trained_labels.h"
#include "ngs/math/stable.h"
#include "support/cameras.h"
#include "support/splat_shapes.h"

namespace ngs {
namespace {

constexpr int kSide_px = 48, kHalf_px = 3, kWallSide = 3 * kSide_px;
/// Of the bar: one unit is one pixel on the bar, half a pixel on the wall behind it.
constexpr float kDistance = kSide_px;

void add_plane(GaussianCloud& cloud, int columns, int rows, double depth, double logit_opacity) {
  for (int i = 0; i < columns * rows; ++i)
    test::add_gaussian(cloud, {i % columns + 0.5 - 0.5 * columns, i / columns + 0.5 - 0.5 * rows, depth}, 0.5, {},
                       logit_opacity);
}

/// A nearly opaque vertical bar of 6 px in front of a wall, seen from seven positions in a row. The mask of a view is
/// shifted by errors_px[view].
struct Bar {
  GaussianCloud cloud;
  Scene scene;
  std::vector<ViewMasks> masks;
  std::vector<LabelColumns> labels;

  static bool inside(int x, double shift_px) { return std::abs(x + 0.5 - kSide_px / 2 - shift_px) < kHalf_px; }

  Problem input() const {
    std::vector<std::size_t> views;
    for (std::size_t v = 0; v < scene.views.size(); ++v) views.push_back(v);
    return {.cloud = cloud,
            .scene = scene,
            .views = views,
            .load_masks = [this](std::size_t v) { return masks[v]; },
            .background = {0, 0, 0},
            .seed = 1,
            .labels = labels};
  }
};

Bar bar(const std::vector<int>& errors_px) {
  Bar b;
  add_plane(b.cloud, 2 * kHalf_px, kSide_px, kDistance, -1);
  add_plane(b.cloud, kWallSide, kWallSide, 2 * kDistance, 3);
  b.scene.objects = {{"bar", 0}};
  for (std::size_t v = 0; v < errors_px.size(); ++v) {
    const int place = 4 * (int(v) - int(errors_px.size()) / 2);
    Camera camera = test::camera_along_z(kSide_px, kSide_px, kDistance);
    camera.name = std::to_string(v) + ".png";
    camera.translation = {-double(place), 0, 0};
    b.scene.views.push_back({camera, "", "", Split::kTrain});
    ViewMasks mask{.width_px = kSide_px, .height_px = kSide_px, .target = {}, .known = {}, .available = true};
    mask.target.resize(1);
    for (int p = 0; p < kSide_px * kSide_px; ++p)
      mask.target[0].push_back(Bar::inside(p % kSide_px, errors_px[v] - place) ? 1.f : 0.f);
    b.masks.push_back(std::move(mask));
  }
  Monitor monitor;
  const Problem input = b.input();
  b.labels =
      label_gaussians({}, accumulate_evidence({}, monitor, {b.cloud, b.scene, input.views, {}, input.load_masks}));
  return b;
}

/// IoU of the true bar with the rendered mask in the middle view, before the first step.
double iou_at_start(const Bar& b, int start_steps) {
  const Problem input = b.input();
  Monitor monitor;
  JointOptions options;
  options.start_steps = start_steps;
  const JointTrainer trainer({}, monitor, {options, {}, {}, input}, true);
  const std::vector<float> label = trainer.result().labels[0].label.values();
  RenderRequest request{.label = {label.data(), b.cloud.size(), 1}};
  const ImageF mask = render({}, b.cloud, b.scene.views[b.scene.views.size() / 2].camera, {}, request).label;
  double both = 0, either = 0;
  for (int p = 0; p < int(mask.data.size()); ++p) {
    const bool found = mask.data[std::size_t(p)] > 0.5f, truth = Bar::inside(p % kSide_px, 0);
    both += found && truth;
    either += found || truth;
  }
  return both / either;
}

}  // namespace

TEST_CASE("label start: a thin object keeps its width under misaligned masks") {
  const Bar b = bar({-4, 2, -2, 0, 2, -2, 4});
  const double shares = iou_at_start(b, 1), started = iou_at_start(b, JointOptions{}.start_steps);
  CAPTURE(shares);
  CAPTURE(started);
  CHECK(shares < 0.7);  // shares below 1, and a bar that is not opaque
  CHECK(started > 0.95);
}

TEST_CASE("label start: contours hardly change if the masks agree") {
  const Bar b = bar({0, 0, 0, 0, 0, 0, 0});
  CHECK(iou_at_start(b, 1) == 1);
  CHECK(iou_at_start(b, JointOptions{}.start_steps) > 0.98);  // correct edges within a Gaussian get steeper too
}

TEST_CASE("label start: steps add log-odds up to a bound, and a half stays a half") {
  CHECK(start_log_odds(0.5, 3) == 0);
  CHECK(start_log_odds(0.6, 3) == doctest::Approx(3 * std::log(0.6 / 0.4)));
  CHECK(start_log_odds(1, 1) == start_log_odds(1, 3));
  CHECK(start_log_odds(0, 3) == doctest::Approx(std::log(0.01 / 0.99)));
}

namespace {

/// Two objects and six Gaussians: one of the first object, one of the second, one of both, one of neither, one unseen,
/// one fixed by hand.
struct Cells {
  GaussianCloud cloud;
  Scene scene;
  std::vector<LabelColumns> labels{2};

  Cells() {
    cloud.resize(6, 0);
    labels[0].prob = {0.9f, 0, 0.4f, 0, 0.9f, 0.9f};
    labels[1].prob = {0, 0.8f, 0.5f, 0.005f, 0, 0};
    for (LabelColumns& object : labels) {
      for (const auto column : {&LabelColumns::label, &LabelColumns::variance, &LabelColumns::boundary})
        (object.*column).assign(6, 0.f);
      object.views = {3, 3, 3, 3, 0, 3};
    }
  }
  Problem problem(std::vector<std::uint8_t> region) const {
    return {.cloud = cloud, .scene = scene, .fixed = {0, 0, 0, 0, 0, 1}, .labels = labels, .region = std::move(region)};
  }
};

/// The labels that a step with gradient 1 everywhere changes, each as "gaussian,object ".
std::string changed_by_step(const Cells& cells, const std::vector<std::uint8_t>& region) {
  const Problem in = cells.problem(region);
  GaussianCloud all = cells.cloud;
  const TrainedRows rows({}, region, {}, all);
  TrainedLabels trained(rows);
  trained.start(in, 1);
  const Matrix<const float> drawn = trained.rendered();
  const std::vector<float> before(drawn.data, drawn.data + 12);
  const AdamGroup group = trained.group({}, 0.1, std::vector<float>(rows.size() * 2, 1.f));
  adam_step({}, 1, {&group, 1});
  trained.write_back({});
  std::vector<LabelColumns> written = cells.labels;
  trained.write(written);
  std::string changed;
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t k = 0; k < 2; ++k) {
      const float now = trained.rendered().data[2 * i + k];
      if (now == before[2 * i + k]) {
        CHECK(written[k].prob[i] == cells.labels[k].prob[i]);
        CHECK(written[k].label[i] == cells.labels[k].label[i]);
        continue;
      }
      CHECK(now < before[2 * i + k]);
      CHECK(written[k].prob[i] == now);
      CHECK(written[k].label[i] == now);
      changed += std::to_string(i) + "," + std::to_string(k) + " ";
    }
  return changed;
}

}  // namespace

TEST_CASE("trained labels: those of the objects whose region contains the Gaussian; all objects if none does") {
  const Cells cells;
  CHECK(changed_by_step(cells, {1, 1, 1, 1, 1, 1}) == "0,0 1,1 2,0 2,1 3,0 3,1 ");
  CHECK(changed_by_step(cells, {0, 1, 0, 0, 1, 1}) == "1,1 ");
  CHECK(changed_by_step(cells, {}) == "0,0 0,1 1,0 1,1 2,0 2,1 3,0 3,1 ");
}

TEST_CASE("trained labels: a step is an Adam step on the log-odds, for any number of threads") {
  const Cells cells;
  const std::vector<std::uint8_t> region{1, 1, 1, 1, 1, 1};
  const Problem in = cells.problem(region);
  GaussianCloud all = cells.cloud;
  const TrainedRows rows({}, region, {}, all);
  std::vector<float> grad(12);
  for (std::size_t i = 0; i < 12; ++i) grad[i] = 0.1f * float(i + 1);
  const auto stepped = [&](int threads) {
    TrainedLabels trained(rows);
    trained.start(in, 1);
    const std::vector<float> start = trained.logit();
    const Exec exec{.threads = threads};
    const AdamGroup group = trained.group(exec, 0.1, grad);
    adam_step(exec, 1, {&group, 1});
    CHECK(trained.moments().m[1] == doctest::Approx(0.1 * grad[3] * sigmoid_slope(start[1])));  // of (1, 1)
    return trained.logit();
  };
  CHECK(stepped(1).size() == 6);
  CHECK(stepped(1) == stepped(3));
}

}  // namespace ngs
