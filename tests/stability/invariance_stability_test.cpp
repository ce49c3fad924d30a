// End to end: labels do not depend on the scene's position, unit or order, and contradicting, overlapping or missing
// masks have a defined result.
#include <doctest/doctest.h>

#include "ngs/core/error.h"
#include "ngs/cut/evidence/variance_stage.h"
#include "ngs/cut/methods/method_bce.h"
#include "ngs/cut/training/joint_trainer.h"
#include "support/changed_labels.h"
#include "support/joint_case.h"
#include "support/method_case.h"
#include "support/same_evidence.h"
#include "support/stability.h"

namespace ngs {
namespace {

using test::MethodCase;
using test::Random;
using test::Worst;

constexpr int kGaussians = 40, kViews = 3;

MethodCase scene(Random& random, int objects = 1) {
  return test::method_case(std::uint64_t(random.below(1 << 30)), kGaussians, kViews, objects);
}
Evidence evidence_of(const MethodCase& c, const std::vector<std::size_t>& views = {0, 1, 2}, int threads = 1) {
  return accumulate_evidence({.threads = threads}, test::Quiet(),
                             {c.cloud, c.scene, views, {}, [&](std::size_t v) { return c.masks[v]; }});
}
std::vector<LabelColumns> labels_of(const MethodCase& c) { return label_gaussians({}, evidence_of(c)); }

/// Equal labels except where the probability is within `bound` of the threshold. One pixel more or less with alpha =
/// 1/255 changes a probability by less than `bound`.
bool same_labels(const LabelColumns& a, const LabelColumns& b, float bound) {
  bool same = true;
  for (std::size_t i = 0; i < a.label.size(); ++i)
    if (a.views[i] > 0 && b.views[i] > 0) same &= a.label[i] == b.label[i] || std::abs(a.prob[i] - 0.5f) < bound;
  return same;
}
float largest_change(const LabelColumns& a, const LabelColumns& b) {
  float worst = 0;
  for (std::size_t i = 0; i < a.prob.size(); ++i) worst = std::max(worst, std::abs(a.prob[i] - b.prob[i]));
  return worst;
}

constexpr float kBound = 0.02f;  // of a probability

}  // namespace

HARD_CASE("invariance: a rotated scene has the same labels", "turn, rad", {1e-3, 1, 3}, 0,
          "not applicable: the reference is the scene itself") {
  const MethodCase c = scene(random);
  MethodCase turned = c;
  const double half = h / 2, s = std::sin(half) / std::sqrt(3.0), w = std::cos(half);
  const Mat3<double> r = rotation_matrix(Vec4<double>{w, s, s, s});
  for (std::size_t i = 0; i < kGaussians; ++i) {
    const Vec3<double> p =
        r * Vec3<double>{c.cloud.position[i * 3], c.cloud.position[i * 3 + 1], c.cloud.position[i * 3 + 2]};
    for (std::size_t k = 0; k < 3; ++k) turned.cloud.position[i * 3 + k] = float((&p.x)[k]);
    const float* q = &c.cloud.rotation[i * 4];  // (w, s, s, s) · q
    const double product[4] = {w * q[0] - s * (q[1] + q[2] + q[3]), w * q[1] + s * (q[0] + q[3] - q[2]),
                               w * q[2] + s * (q[0] + q[1] - q[3]), w * q[3] + s * (q[0] + q[2] - q[1])};
    for (std::size_t k = 0; k < 4; ++k) turned.cloud.rotation[i * 4 + k] = float(product[k]);
  }
  for (SceneView& view : turned.scene.views) view.camera.rotation = view.camera.rotation * transpose(r);
  worst.ours_is(same_labels(labels_of(c)[0], labels_of(turned)[0], kBound));
}

HARD_CASE("invariance: a scene with an origin offset has the same labels anywhere in the world", "translation, world",
          {1, 1e3, 1e6}, 0, {"positions in world coordinates, in float", test::kWrong}) {
  const MethodCase c = scene(random);
  MethodCase moved = c, naive = c;
  moved.cloud.origin = {h, -2 * h, 0.5 * h};
  const Vec3<double> origin{h, -2 * h, 0.5 * h};
  for (std::size_t v = 0; v < kViews; ++v)
    for (MethodCase* m : {&moved, &naive}) {
      Camera& camera = m->scene.views[v].camera;
      camera.translation = camera.translation - camera.rotation * origin;
    }
  for (std::size_t i = 0; i < naive.cloud.position.size(); ++i) naive.cloud.position[i] += float((&origin.x)[i % 3]);
  const auto want = labels_of(c)[0], got = labels_of(moved)[0];
  worst.ours_is(same_labels(want, got, kBound) && largest_change(want, got) < kBound);
  worst.naive_is(largest_change(want, labels_of(naive)[0]) < kBound);
}

HARD_CASE("invariance: permuted views and any number of threads give the same bits", "threads", {1, 2, 7}, 0,
          "not applicable: sums in float depend on the order of arrival", 4) {
  const MethodCase c = scene(random);
  const Evidence a = evidence_of(c), b = evidence_of(c, {2, 0, 1}, int(h));
  worst.ours_is(test::same_evidence(a, b));
}

HARD_CASE("invariance: permuted objects have permuted labels", "objects", {2}, 0,
          "not applicable: the reference is the scene itself") {
  const MethodCase c = scene(random, 2);
  MethodCase swapped = c;
  std::swap(swapped.scene.objects[0], swapped.scene.objects[1]);
  for (ViewMasks& m : swapped.masks) std::swap(m.target[0], m.target[1]);
  const auto a = labels_of(c), b = labels_of(swapped);
  worst.ours_is(a[0].prob == b[1].prob && a[1].variance == b[0].variance);
  for (std::size_t i = 0; i < kGaussians; ++i)  // an exact tie goes to the first of the two
    if (a[0].prob[i] != a[1].prob[i]) worst.ours_is(a[0].label[i] == b[1].label[i] && a[1].label[i] == b[0].label[i]);
}

HARD_CASE("invariance: float labels differ from the rendering equation in double only near the threshold", "Gaussians",
          {kGaussians}, 0.45, "not applicable: the reference is the printed form in double", 4) {
  const MethodCase c = scene(random);
  const test::ReferenceWeights want = test::reference_weights(c);
  if (!want.clear) return;
  const LabelColumns got = labels_of(c)[0];
  for (std::size_t i = 0; i < want.weight.size(); ++i)
    if (want.weight[i] > 0)
      worst.ours_ratio(std::abs(double(got.prob[i]) - want.object_weight[i] / want.weight[i]) /
                       (0x1p-23 * want.spread[i] / want.weight[i]));
}

HARD_CASE("masks: two views that contradict each other give probability one half and the largest variance", "views",
          {2}, 0, "not applicable: a count decides") {
  MethodCase c = scene(random);
  c.scene.views[1].camera = c.scene.views[0].camera;
  c.masks[1] = c.masks[0];
  for (float& m : c.masks[1].target[0]) m = 1 - m;
  const Evidence e = evidence_of(c, {0, 1});
  const LabelColumns l = label_gaussians({}, e)[0];
  for (std::size_t i = 0; i < kGaussians; ++i)
    if (e.views[i] > 0)
      worst.ours_is(std::abs(l.prob[i] - 0.5f) < 1e-6f && l.variance[i] > 0.999f && l.boundary[i] == 1);
}

HARD_CASE("masks: where two objects overlap a Gaussian belongs to one at most", "overlap", {0, 1}, 0,
          {"each object's own threshold", test::kWrong}) {
  MethodCase c = scene(random, 2);
  for (ViewMasks& m : c.masks)
    for (std::size_t p = 0; p < m.target[0].size(); ++p) m.target[1][p] = h > 0 ? m.target[0][p] : 1 - m.target[0][p];
  const auto l = labels_of(c);
  int naive = 0;
  for (std::size_t i = 0; i < kGaussians; ++i) {
    worst.ours_is(l[0].label[i] + l[1].label[i] <= 1);
    naive += l[0].prob[i] > 0.5f && l[1].prob[i] > 0.5f;
  }
  worst.naive_is(naive == 0);
}

HARD_CASE("masks: an object with a mask in one view only is labelled from that view", "views with a mask", {3, 1}, 0,
          {"variance over V - 1 views", test::kWrong}, 4) {
  MethodCase c = scene(random);
  for (std::size_t v = std::size_t(h); v < kViews; ++v) c.masks[v].available = false;
  const Solution result = solve_bce({}, test::Quiet(), {}, c.input()).method;
  for (std::size_t i = 0; i < kGaussians; ++i)
    worst.ours_is(result.labels[0].label[i] >= 0 && result.labels[0].label[i] <= 1 &&
                  result.labels[0].views[i] <= float(h));
  VarianceOptions between;
  between.criterion = Criterion::kBetweenViews;
  const Evidence e = evidence_of(c);
  const LabelColumns columns = label_gaussians(between, e)[0];
  for (const float v : columns.variance) worst.ours_is(v >= 0 && v <= 1);
  for (std::size_t i = 0; i < kGaussians; ++i) {
    if (e.views[i] != std::uint32_t(h)) continue;
    const ObjectSums* const of = e.object_weights.find(i, 0);
    const double views = e.views[i], sum = of ? double(of->signal_sum) * 0x1p-32 : 0,
                 squares = of ? of->signal_square_sum.value() : 0;
    const double unbiased = 4 * (squares - sum * sum / views) / (views - 1);
    worst.naive_is(std::isfinite(unbiased));
  }
}

namespace {

struct JointRun {
  Monitor monitor;
  JointOptions options;
  SampleOptions sample;
  RbfOptions rbf;
  Problem input;
  JointTrainer trainer;
  static JointOptions small() {
    JointOptions o;
    o.steps = 4;
    o.hash_levels = 2;
    o.hash_log2_table = 6;
    o.hash_finest = 32;
    o.mlp_hidden = 16;
    o.smooth_points = 16;
    return o;
  }
  static SampleOptions few() {
    SampleOptions s{.rows = 6, .cols = 6, .depth_samples = 3};
    return s;
  }
  JointRun(const test::JointCase& c, bool empty_is_fine)
      : options(small()),
        sample(few()),
        input(c.input()),
        trainer({}, monitor, {options, sample, rbf, input, nullptr}, empty_is_fine) {}
  bool run() {
    while (!trainer.finished()) trainer.step();
    for (const StateBlock& block : trainer.state())
      for (const float x : *block.values)
        if (!std::isfinite(x)) return false;
    return true;
  }
};

}  // namespace

HARD_CASE("joint: a photo with one NaN stops the step and names the view", "NaNs", {1}, 0,
          "not applicable: a step is taken or it is not", 100) {
  const auto c = test::joint_case(60, 40);
  for (ImageF& photo : c->photos) photo.data[std::size_t(random.below(std::int64_t(photo.data.size())))] = NAN;
  JointRun run(*c, false);
  bool named = false;
  try {
    run.trainer.step();
  } catch (const Error& e) {
    named = e.code() == ErrorCode::kNumeric && std::string(e.what()).find("view 'view") != std::string::npos;
  }
  worst.ours_is(named && run.trainer.steps_done() == 0);
}

HARD_CASE("joint: training stays finite with no, one or all Gaussians in the boundary", "boundary share",
          {0.5, 0.01, 1, 0}, 0, "not applicable: sets, not formulas", 100) {
  const auto c = test::joint_case(60, 40);
  auto& boundary = c->labels[0].boundary;
  test::change(boundary, [&](float) { return random.uniform(0, 1) < h ? 1.f : 0.f; });
  if (h == 0.01) {
    boundary.assign(boundary.size(), 0.f);
    boundary[5] = 1;
  }
  bool refused = false;
  if (h == 0) {
    try {
      JointRun strict(*c, false);
    } catch (const Error& e) {
      refused = e.code() == ErrorCode::kNothingFound;
    }
  }
  worst.ours_is(refused == (h == 0) && JointRun(*c, true).run());
}

}  // namespace ngs
