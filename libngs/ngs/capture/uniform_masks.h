#pragma once
// Checks empty and full masks: is the object absent from these views, or did the tool that made the masks lose it? Does
// it fill the picture, or is the file no mask?
//
// Up to 16 of the masks that are not empty label the Gaussians visible in their views (closed form,
// cut/evidence/variance_stage.h); an unseen Gaussian gets the label of the nearest seen one. The labels are rendered in
// the views with such a mask, with occlusion. An empty mask is contradicted if the rendered object covers more than a
// quarter of its usual area, a full one if it covers less than half of the picture. Limit: background that the other
// views show only through the object, such as the wall behind it, is labelled as object.
#include "ngs/capture/scene_findings.h"
#include "ngs/core/monitor.h"
#include "ngs/cut/evidence/variance_stage.h"
#include "ngs/scene/scene.h"

namespace ngs {

struct UniformMaskSearch {
  const GaussianCloud* cloud;  // null: masks are only counted
  const Scene& scene;
  const SceneLoaders& loaders;
};
/// Finds empty and full masks, and checks them against the others, unless a missing mask means an empty one
/// (MissingMask::kEmpty) or the masks agree too little to locate the object. `result` has the masks of all views.
void find_uniform_masks(const Exec& exec, Monitor& monitor, const UniformMaskSearch& in, SceneCheck& result);

}  // namespace ngs
