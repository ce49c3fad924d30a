#pragma once
// Options shared by all code that trains labels and Gaussians.
#include "ngs/cut/training/joint_options.h"

namespace ngs {

struct TrainingOptions {
  JointOptions joint;
  SampleOptions sample;
  RbfOptions rbf;
};

}  // namespace ngs
