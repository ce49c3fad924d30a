#pragma once
// How the fit changes the number of Gaussians: clone, split and prune as in 3DGS.
#include "ngs/backend/exec.h"
#include "ngs/stages/fit/fit_state.h"

namespace ngs {

struct DensityRule {
  double gradient = 2e-4;     // mean view-space gradient, per NDC
  double dense_scale = 0.01;  // world: larger Gaussians are split in two, smaller ones cloned
  double min_opacity = 0.005;
  double max_scale = 0;                  // world: larger ones are pruned; 0: no limit
  std::int64_t max_gaussians = 1000000;  // the candidates with the largest gradients come first
};

struct DensityChange {
  std::int64_t cloned = 0, split = 0, pruned = 0;
};

/// Kept Gaussians stay in order, then come clones, then the children of splits (drawn from the parent's own
/// distribution, scales / 1.6). New Gaussians start with zero moments; the gradient statistics start afresh.
/// At least one Gaussian is kept. `seed` must differ from call to call.
DensityChange densify_and_prune(const Exec& exec, FitState& state, const DensityRule& rule, std::uint64_t seed);

}  // namespace ngs
