#pragma once
// Checks the masks of a scene.
#include "ngs/capture/scene_findings.h"
#include "ngs/core/monitor.h"

namespace ngs {

struct MaskCheckInputs {
  const Scene& scene;
  const SceneLoaders& loaders;
  bool refuses_inverted = true;
};

/// Fills `masks` of every training view and `objects`. Warns about JPEG files, full masks and masks that look inverted.
/// Throws kInconsistent if all masks of an object are empty or all are full. With `refuses_inverted` it also throws if
/// the masks of the only object look inverted and neither mask_invert nor label maps explain it.
void check_masks(Monitor& monitor, const MaskCheckInputs& in, SceneCheck& result);

}  // namespace ngs
