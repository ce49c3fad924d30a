#pragma once
// A picture of what a cleaning does: the scene before, after, and what was removed, from two sides.
#include <string>

#include "ngs/backend/exec.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs::clean {

/// Two rows (sides) of three pictures (before, after, removed). The cameras look at the bulk of the model as it was, a
/// little from above; of a room they stand in it. Needs a Gaussian that can be seen: kNothingFound otherwise.
void write_preview(const Exec& exec, const GaussianCloud& cloud, const std::vector<std::uint8_t>& keep,
                   const std::string& path);

}  // namespace ngs::clean
