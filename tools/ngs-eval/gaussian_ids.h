#pragma once
// --instances for the Gaussians of a labelled model instead of id maps.
#include <string>

#include "ngs/eval/instances.h"

namespace ngs::cli {

bool is_model(const std::string& path);

/// The Gaussians of a labelled PLY by object, the first one 1, and by true id: another labelled PLY, or the bare ids,
/// one byte or two (little-endian) a Gaussian. An object's Gaussians have a label above 1/2, the largest of all
/// objects. kInconsistent if the numbers of Gaussians differ.
InstanceCounts count_gaussians(const std::string& predicted, const std::string& truth);

}  // namespace ngs::cli
