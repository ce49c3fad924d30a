#pragma once
// Reports the parts of the object's surface that no view of the scene sees.
#include "extractor.h"
#include "ngs/scene/scene.h"

namespace ngs::cli {

/// Call it after Extractor::decide(). Reports nothing if the object is empty.
void report_unseen_surface(Run& run, const Extractor& extractor, const Scene& scene);

}  // namespace ngs::cli
