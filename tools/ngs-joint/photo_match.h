#pragma once
// Checks that the input model matches the photos.
#include <string>

#include "ngs/problem/problem.h"
#include "shared/run/run.h"

namespace ngs::joint {

/// Throws kInconsistent if the model in the file `path` matches the photos worse than import requires while the scene's
/// own model matches them: it belongs to another scene. Warns if neither matches, as after an import with a lower
/// bound.
void compare_with_photos(cli::Run& run, const Problem& problem, const std::string& path);

}  // namespace ngs::joint
