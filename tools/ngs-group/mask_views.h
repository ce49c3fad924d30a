#pragma once
// Masks of everything: label maps of the views whose ids mean nothing in other views.
#include <string>
#include <vector>

#include "ngs/cut/groups/view_gaussians.h"
#include "ngs/scene/scene.h"
#include "shared/run/run.h"

namespace ngs::group {

/// The scene whose label maps are those of `folder`, by their names; an empty folder: those of the scene. Masks of
/// held-out views are not used. kInconsistent: no view has one.
Scene with_masks_of(cli::Run& run, Scene scene, const std::string& scene_path, const std::string& folder);

/// The masks of a view at the size of their file, numbered by ascending id. Empty: the view has none.
NumberedMasks read_masks(const Scene& scene, std::size_t view);

/// The nearest pixels of masks for a camera's size.
NumberedMasks at_size_of(const Camera& camera, NumberedMasks masks);

}  // namespace ngs::group
