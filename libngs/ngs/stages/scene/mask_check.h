#pragma once
// The masks' part of a check of a scene.
#include "ngs/core/monitor.h"
#include "ngs/stages/scene/scene_findings.h"

namespace ngs {

/// Fills `masks` of every training view and `objects`; warns about JPEG files, full masks and masks that look
/// inverted; throws kInconsistent where all masks of an object are empty or all are full.
void check_masks(Monitor& monitor, const Scene& scene, const SceneLoaders& loaders, SceneCheck& result);

}  // namespace ngs
