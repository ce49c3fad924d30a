#pragma once
// Adaptive density control of the fit: clone, split and prune as in 3DGS.
#include <cstdint>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/make/fit/gaussian_adam.h"

namespace ngs {

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
