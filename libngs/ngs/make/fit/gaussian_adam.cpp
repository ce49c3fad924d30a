#include "ngs/make/fit/gaussian_adam.h"

namespace ngs {

int group_width(const GaussianCloud& cloud, std::size_t group) {
  const int widths[kGaussianGroups] = {3, 4, 3, 1, 3, 3 * cloud.rest_count()};
  return widths[group];
}

std::vector<AdamGroup> gaussian_groups(const GaussianStep& step, const CloudGradients& gradients, GaussianCloud& cloud,
                                       GaussianMoments& moments) {
  std::vector<AdamGroup> groups;
  for (std::size_t g = 0; g < kGaussianGroups; ++g) {
    const auto& [name, value, gradient] = kGroupColumns[g];
    if (step.rates[g] > 0 && !(cloud.*value).empty())
      groups.push_back({{.lr = step.rates[g], .sparse_columns = step.sparse ? group_width(cloud, g) : 0},
                        {name, cloud.*value, gradients.*gradient},
                        moments[g]});
  }
  return groups;
}

void step_gaussians(const Exec& exec, const GaussianStep& step, const CloudGradients& gradients, GaussianCloud& cloud,
                    GaussianMoments& moments) {
  adam_step(exec, step.number, gaussian_groups(step, gradients, cloud, moments));
}

}  // namespace ngs
