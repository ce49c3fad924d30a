#pragma once
// Everything of a fit that later steps read (stages/fit/fit_stage.h).
#include <cstdint>
#include <vector>

#include "ngs/stages/fit/gaussian_adam.h"

namespace ngs {

struct FitState {
  std::int64_t step = 0;  // steps done
  GaussianCloud cloud;
  GaussianMoments moments;
  std::vector<float> gradient_sum;  // [N] Σ |∂L/∂mean| in NDC over the views that saw it since the last densification
  std::vector<float> gradient_views;  // [N] their number
};

}  // namespace ngs
