#pragma once
// Options shared by all code that trains labels and Gaussians.
#include "ngs/cut/training/joint_options.h"
#include "ngs/cut/training/loss_list.h"

namespace ngs {

struct TrainingOptions {
  JointOptions joint;
  SampleOptions sample;
  RbfOptions rbf;
  Losses losses = all_losses();  // copies of these options share them
};

}  // namespace ngs
