#pragma once
// How fine positions have to be, and whether float holds them where a model lies in the world.
#include "ngs/scene/gaussian_cloud.h"

namespace ngs {

/// The median over the usable Gaussians of their middle standard deviation, world; 0 without any.
double usual_size(const GaussianCloud& cloud);

/// Whether float coordinates of the world are too coarse: at the cloud's origin they lie farther apart than a 16th of
/// the usual size. Files of such a model hold positions relative to the origin. False where the origin is 0.
bool needs_local_origin(const GaussianCloud& cloud);

/// The distance of neighbouring floats at the cloud's origin, world.
double float_spacing(const GaussianCloud& cloud);

}  // namespace ngs
