#pragma once
// How near to a camera something is still drawn.                                                   PAPER.md §5.1
#include "ngs/scene/compat.h"

namespace ngs {

/// World, along the camera's axis.
constexpr double near_plane(Compat compat) { return compat == Compat::kInria ? 0.2 : 0.01; }

}  // namespace ngs
