#pragma once
// Writes the object with --finish: clipped to the places that the views of the scene support.
#include "extractor.h"
#include "ngs/scene/scene.h"
#include "ngs/stages/finish/finish_stage.h"

namespace ngs::cli {

/// Throws kUsage for --finish without --scene or without --object-ply.
void check_finish_options(const finish::FinishOptions& options, const Output& object, const Input& scene);

/// Call it after Extractor::decide(). Uses the masks of the scene's training views that have one.
void write_finished(Run& run, const Extractor& extractor, const Scene& scene, const std::string& path);

}  // namespace ngs::cli
