#pragma once
// The steps of a JointTrainer on a device, where the state of the run stays. Nothing waits for a step but who asks for
// losses or parameters, and a look, after 1, 2, 4, ... steps and every kSettleEvery, at whether one could not be taken. A
// step whose lists of tiles outgrew their room is done again, with those after it; an unusable gradient is the error of
// adam_step.
#include <array>
#include <string>

#include "ngs/ops/device/device_joint.h"
#include "ngs/stages/fit/gaussian_adam.h"
#include "ngs/passes/joint/joint_field.h"
#include "ngs/problem/problem.h"

namespace ngs {

/// A trainer's parts; those that are trained are written by download().
struct ResidentModel {
  const JointOptions& options;
  const JointSwitches& effects;
  const SampleOptions& sample;
  const Problem& input;
  const SplatOptions& splat;
  const GroupRates& rates;  // of a step, before they fall
  GaussianCloud& cloud;
  std::vector<float>& logit;
  const std::vector<std::uint8_t>&trainable, &frozen;
  const BoundarySet& boundary;
  const KnnGraph& colour_graph;
  JointField* field;
  AdamMoments& label_moments;
  GaussianMoments& moments;
};

class ResidentSteps {
 public:
  struct Views {
    std::function<std::size_t(std::int64_t step)> at;           // position in the input's views
    std::function<JointView(std::size_t n)> view;
    std::function<FieldRays(std::size_t n)> given;              // of an artifact; empty: sampled
    std::function<std::string(std::int64_t step)> context;      // for errors
  };
  ResidentSteps(const DeviceJointOps& ops, const ResidentModel& model, Views views);

  /// The host's state is the newer one from now on, `done` steps behind it.
  void host_changed(std::int64_t done) { asked_ = done, resident_ = false; }
  void step(std::int64_t planned_steps);
  JointLosses losses();
  /// Brings parameters and moments to the host.
  void download();

 private:
  static constexpr std::uint64_t kSettleEvery = 64;
  void launch(std::int64_t step);
  void settle();

  std::vector<JointBlock> blocks_;
  std::int64_t views_count_;
  Views views_;
  std::unique_ptr<DeviceJoint> joint_;
  std::int64_t asked_ = 0, begun_ = 0, planned_ = 0;
  bool resident_ = false;
};

}  // namespace ngs
