#pragma once
// Writes the object, and each of several alone; with a scene clipped to the places that its views support.
#include "extractor.h"
#include "ngs/scene/scene.h"
#include "outputs.h"

namespace ngs::cli {

/// Call it after Extractor::decide(). `scene`: clips the objects to its views and to the masks of its training views;
/// null: they are written as they are. The objects' own files are written only if there are several.
void write_objects(Run& run, const Extractor& extractor, const Scene* scene, const Outputs& out);

}  // namespace ngs::cli
