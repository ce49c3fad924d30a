#pragma once
// What the report says of the sides of the object that no view of the scene has seen.
#include "extractor.h"
#include "ngs/scene/scene.h"

namespace ngs::cli {

/// After Extractor::decide(). Nothing where the object is empty.
void tell_unseen_surface(Run& run, const Extractor& extractor, const Scene& scene);

}  // namespace ngs::cli
