#pragma once
// A preview of the cleaning: the scene before, after, and the removed Gaussians, from two sides.
#include <string>

#include "ngs/backend/exec.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs::clean {

/// Two rows (sides) of three pictures (before, after, removed). The cameras look at the bulk of the input model,
/// slightly from above; for a room they are inside. Throws kNothingFound if no Gaussian is visible.
void write_preview(const Exec& exec, const GaussianCloud& cloud, const std::vector<std::uint8_t>& keep,
                   const std::string& path);

}  // namespace ngs::clean
