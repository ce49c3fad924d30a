#pragma once
// Adaptive density control of the fit: clone, split and prune as in 3DGS.
#include <array>
#include <cstdint>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/ops/optim/adam.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs {

// The parameter groups of a cloud, each with its own learning rate as in 3DGS, and Adam steps on them.

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

/// The state of a fit: everything that later steps read (make/fit/fit_stage.h).
struct FitState {
  std::int64_t step = 0;  // steps done
  GaussianCloud cloud;
  GaussianMoments moments;
  // Over the views in which the Gaussian was visible since the last densification.
  std::vector<float> gradient_sum;    // [N] Σ |∂L/∂mean| in NDC
  std::vector<float> gradient_views;  // [N] number of these views
};

struct DensityRule {
  double gradient = 2e-4;     // mean view-space gradient, per NDC
  double dense_scale = 0.01;  // world: larger Gaussians are split in two, smaller ones cloned
  double min_opacity = 0.005;
  double max_scale = 0;                  // world: larger Gaussians are pruned; 0: no limit
  std::int64_t max_gaussians = 1000000;  // at the limit the candidates with the largest gradients are used
};

struct DensityChange {
  std::int64_t cloned = 0, split = 0, pruned = 0;
};

/// Row order: the remaining Gaussians in their order, then clones, then the children of splits (drawn from the parent's
/// distribution, scales / 1.6). New Gaussians start with zero moments. The gradient statistics are reset. At least one
/// Gaussian remains. `seed` must differ from call to call.
DensityChange densify_and_prune(const Exec& exec, FitState& state, const DensityRule& rule, std::uint64_t seed);

}  // namespace ngs
