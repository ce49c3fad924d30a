#pragma once
// The fraction of a model in front of a camera and inside its image, from a sample: accurate to 0.1 %, fast for any
// size.
#include <cstdint>
#include <vector>

#include "ngs/scene/camera.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs {

/// Usable rows among at most 2^18 evenly spaced rows.
std::vector<std::int64_t> sample_usable(const GaussianCloud& cloud);

struct ViewShares {
  double in_front = 0;  // fraction with camera z > 0
  double inside = 0;    // fraction whose centre projects into the image
};

/// Fractions of the sample, which must not be empty.
ViewShares view_shares(const GaussianCloud& cloud, const Camera& camera, const std::vector<std::int64_t>& sample);

/// `count` evenly spaced indices below n: the middles of `count` equal parts.
std::vector<std::size_t> evenly_spaced(std::size_t count, std::size_t n);

}  // namespace ngs
