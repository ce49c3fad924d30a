#pragma once
// Whether float world coordinates are precise enough for a model at its place in the world.
#include "ngs/scene/gaussian_cloud.h"

namespace ngs {

/// Median over the usable Gaussians of the middle one of their three standard deviations, world; 0 if none is usable.
double usual_size(const GaussianCloud& cloud);

/// Whether float world coordinates are too coarse: their spacing at the cloud's origin exceeds 1/16 of usual_size().
/// Files of such a model hold positions relative to the origin. False if the origin is 0.
bool needs_local_origin(const GaussianCloud& cloud);

/// The spacing of floats at the cloud's origin, world.
double float_spacing(const GaussianCloud& cloud);

}  // namespace ngs
