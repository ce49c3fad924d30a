#pragma once
// Reads a scene, requires its model, and protects its photos from being overwritten.
#include <string>
#include <vector>

#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/scene/boundary_set.h"
#include "ngs/scene/scene.h"
#include "shared/run/run.h"

namespace ngs::cli {

/// Reads a scene.json. If its photos are renders of the model, "result" of the report records that.
Scene read_scene(Run& run, const std::string& path);

/// Adds the scene's model to the inputs of the run. Throws kBadInput if the scene names no model or the model is no
/// regular file.
void require_model(Run& run, const Scene& scene, const std::string& scene_path);

/// Throws kUsage if one of `files`, which the run would write, is a photo of the scene.
void refuse_over_photos(const Scene& scene, const std::vector<std::string>& files);

// Reads the boundary set of a PLY of ngs-variance, for ngs-sample, ngs-rbf and ngs-joint.

/// The boundary Gaussians of a labelled PLY; with several objects, of their union. Throws kBadInput if the PLY has no
/// ngs_boundary, and kNothingFound if the set is empty (unless --allow-empty).
BoundarySet boundary_of(Run& run, const io::GaussianPly& ply, const std::string& path);

}  // namespace ngs::cli
