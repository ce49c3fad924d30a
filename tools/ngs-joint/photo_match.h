#pragma once
// Does the model that is to be optimised show what the photos show?
#include <string>

#include "ngs/problem/problem.h"
#include "shared/run/run.h"

namespace ngs::joint {

/// Refuses a model (of the file `path`) that explains the photos worse than import asks for where the scene's own
/// explains them: it is another scene's (kInconsistent). Warns where neither does, as of a scene that was imported with
/// a lower bound.
void compare_with_photos(cli::Run& run, const Problem& problem, const std::string& path);

}  // namespace ngs::joint
