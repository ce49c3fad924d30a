#pragma once
// How much of a model a camera has before it, from a sample: exact to 0.1 % and fast for any model.
#include <cstdint>
#include <vector>

#include "ngs/scene/camera.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs {

/// Usable rows, evenly spread: of at most 2^18.
std::vector<std::int64_t> sample_usable(const GaussianCloud& cloud);

struct ViewShares {
  double in_front = 0;  // share with camera z > 0
  double inside = 0;    // share whose centre projects into the image
};

/// Of the sample, which must not be empty.
ViewShares view_shares(const GaussianCloud& cloud, const Camera& camera, const std::vector<std::int64_t>& sample);

}  // namespace ngs
