#pragma once
// Finds needles at the cut: long thin Gaussians of the object that reach into the removed background, for example below
// a statue without its pedestal. Thin parts of the object that end in empty space are no needles.
#include <cstdint>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs {

/// The rows, ascending, of Gaussians with object[i] != 0 whose longest axis is at least three times the second longest
/// and has an end, at two standard deviations, that is farther than `margin` (world) from every compact solid Gaussian
/// of the object, but not from those of the background. None if `margin` is 0.
std::vector<std::uint32_t> needles_beyond(const Exec& exec, const GaussianCloud& cloud,
                                          const std::vector<std::uint8_t>& object, double margin);

}  // namespace ngs
