#pragma once
// The parameter groups of a cloud, each with its own learning rate as in 3DGS, and Adam steps on them.
#include <array>

#include "ngs/ops/optim/adam.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs {

enum GaussianGroup {
  kGroupPosition,
  kGroupRotation,
  kGroupScale,
  kGroupOpacity,
  kGroupDc,
  kGroupRest,
  kGaussianGroups
};

struct GroupColumns {
  const char* name;
  std::vector<float> GaussianCloud::*value;
  std::vector<float> CloudGradients::*gradient;
};
inline constexpr GroupColumns kGroupColumns[kGaussianGroups] = {
    {"position", &GaussianCloud::position, &CloudGradients::position},
    {"rotation", &GaussianCloud::rotation, &CloudGradients::rotation},
    {"log_scale", &GaussianCloud::log_scale, &CloudGradients::log_scale},
    {"logit_opacity", &GaussianCloud::logit_opacity, &CloudGradients::logit_opacity},
    {"sh_dc", &GaussianCloud::sh_dc, &CloudGradients::sh_dc},
    {"sh_rest", &GaussianCloud::sh_rest, &CloudGradients::sh_rest}};

/// Number of values per Gaussian.
int group_width(const GaussianCloud& cloud, std::size_t group);

using GroupRates = std::array<double, kGaussianGroups>;
using GaussianMoments = std::array<AdamMoments, kGaussianGroups>;

struct GaussianStep {
  std::int64_t number;  // from 1
  GroupRates rates;
  bool sparse = false;  // Gaussians without a gradient keep values and moments
};

/// The groups whose rate is not 0, for adam_step(). The arguments must outlive them.
std::vector<AdamGroup> gaussian_groups(const GaussianStep& step, const CloudGradients& gradients, GaussianCloud& cloud,
                                       GaussianMoments& moments);

/// A group whose rate is 0 keeps its values and moments.
void step_gaussians(const Exec& exec, const GaussianStep& step, const CloudGradients& gradients, GaussianCloud& cloud,
                    GaussianMoments& moments);

}  // namespace ngs
