#pragma once
// The state of a fit: everything that later steps read (make/fit/fit_stage.h).
#include <cstdint>
#include <vector>

#include "ngs/make/fit/gaussian_adam.h"

namespace ngs {

struct FitState {
  std::int64_t step = 0;  // steps done
  GaussianCloud cloud;
  GaussianMoments moments;
  // Over the views in which the Gaussian was visible since the last densification.
  std::vector<float> gradient_sum;    // [N] Σ |∂L/∂mean| in NDC
  std::vector<float> gradient_views;  // [N] number of these views
};

}  // namespace ngs
