#pragma once
// What is noted of masks in colours and greys.
#include "ngs/scene/mask_samples.h"

namespace ngs {

/// Whether a mask in colours has several besides that of the ground, as a map of objects.
bool has_several_colours(const MaskSamples& samples);
/// Whether a grey picture has many greys, as one of depth.
bool has_many_greys(const MaskSamples& samples);

}  // namespace ngs
