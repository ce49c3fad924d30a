#pragma once
// What everything that trains labels and Gaussians listens to.
#include "ngs/passes/joint/joint_options.h"

namespace ngs {

struct TrainingOptions {
  JointOptions joint;
  SampleOptions sample;
  RbfOptions rbf;
};

}  // namespace ngs
