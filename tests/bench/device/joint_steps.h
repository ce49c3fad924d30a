#pragma once
// The joint stage on a synthetic scene, to time a step on the CPU and on a device.
#include <chrono>
#include <cmath>

#include "bench_scene.h"
#include "ngs/cut/training/joint_trainer.h"

namespace ngs::bench {

class JointSteps {
 public:
  static constexpr int kViews = 4;

  explicit JointSteps(std::int64_t gaussians) : bench_(bench_scene(gaussians, 1152, 864)) {
    scene_.objects = {{"ball", 1}};
    for (int v = 0; v < kViews; ++v) {
      Camera camera = bench_.camera;
      camera.name = std::to_string(v);
      const double angle = 0.05 * v;
      camera.rotation = {{std::cos(angle), 0, -std::sin(angle), 0, 1, 0, std::sin(angle), 0, std::cos(angle)}};
      scene_.views.push_back({camera, "", "", Split::kTrain});
    }
    const auto n = std::size_t(bench_.cloud.size());
    LabelColumns& labels = labels_.emplace_back();
    labels.label.assign(n, 0.f);
    labels.variance.assign(n, 0.f);
    labels.views.assign(n, 4.f);
    for (std::size_t i = 0; i < n; ++i) {
      labels.prob.push_back(i % 2 == 0 ? 0.8f : 0.2f);
      labels.boundary.push_back(i % 40 == 0);
    }
    photo_ = ImageF(bench_.camera.width_px, bench_.camera.height_px, 3, 0.4f);
  }
  std::int64_t gaussians() const { return bench_.cloud.size(); }

  /// Seconds per step, after two warm-up epochs. Calls around(true) before and around(false) after the measured steps.
  template <class Around>
  double seconds(const Exec& exec, int steps, const Around& around) const {
    const Problem input{.cloud = bench_.cloud,
                        .scene = scene_,
                        .views = {0, 1, 2, 3},
                        .load_masks = [&](std::size_t) { return bench_.masks; },
                        .load_photo = [&](std::size_t) { return photo_; },
                        .labels = labels_};
    JointOptions options;
    options.steps = 2 * kViews + steps;
    const SampleOptions sample;
    const RbfOptions rbf;
    Monitor monitor;
    JointTrainer trainer(exec, monitor, {.options = options, .sample = sample, .rbf = rbf, .input = input}, false);
    for (int i = 0; i < 2 * kViews; ++i) trainer.step();
    around(true);
    const auto begin = std::chrono::steady_clock::now();
    while (!trainer.finished()) trainer.step();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    around(false);
    return took.count() / steps;
  }

 private:
  BenchScene bench_;
  Scene scene_;
  std::vector<LabelColumns> labels_;
  ImageF photo_;
};

}  // namespace ngs::bench
