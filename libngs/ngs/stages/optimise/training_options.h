#pragma once
// What everything that trains labels and Gaussians listens to.
#include "ngs/stages/optimise/joint_options.h"

namespace ngs {

struct TrainingOptions {
  JointOptions joint;
  SampleOptions sample;
  RbfOptions rbf;
};

}  // namespace ngs
