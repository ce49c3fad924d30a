#pragma once
// The masks' part of a check of a scene.
#include "ngs/core/monitor.h"
#include "ngs/stages/scene/scene_findings.h"

namespace ngs {

struct MaskCheckInputs {
  const Scene& scene;
  const SceneLoaders& loaders;
  bool refuses_inverted = true;
};

/// Fills `masks` of every training view and `objects`; warns about JPEG files, full masks and masks that look
/// inverted; throws kInconsistent where all masks of an object are empty or all are full, and where those of the only
/// object look inverted, are not said to be, and are to be refused.
void check_masks(Monitor& monitor, const MaskCheckInputs& in, SceneCheck& result);

}  // namespace ngs
