#pragma once
// Masks of everything: label maps of the views whose ids mean nothing in other views.
#include <string>
#include <vector>

#include "ngs/cut/groups/view_gaussians.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/scene/scene.h"
#include "shared/run/run.h"

namespace ngs::group {

/// The scene whose label maps are those of `folder`, by their names; an empty folder: those of the scene. Masks of
/// held-out views are not used. kInconsistent: no view has one.
Scene with_masks_of(cli::Run& run, Scene scene, const std::string& scene_path, const std::string& folder);

/// The masks of a view at the size of their file, numbered by ascending id. Empty: the view has none.
NumberedMasks read_masks(const Scene& scene, std::size_t view);

/// Upwards: as the model's comment says, or guessed; unit length.
Vec3<double> up_of(const io::GaussianPly& ply);

/// The masks of each of `views` that the splat alone gives (surface_parts.h), at the size of depth_view(); the same
/// numbers in all views. Empty after a stop request.
std::vector<NumberedMasks> masks_of_surface(cli::Run& run, const Scene& scene, const std::vector<std::size_t>& views,
                                            const io::GaussianPly& ply, const SplatOptions& splat);

/// The nearest pixels of masks for a camera's size.
NumberedMasks at_size_of(const Camera& camera, NumberedMasks masks);

}  // namespace ngs::group
