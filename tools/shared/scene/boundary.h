#pragma once
// Reads the boundary set of a PLY of ngs-variance, for ngs-sample, ngs-rbf and ngs-joint.
#include <string>

#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/scene/boundary_set.h"
#include "shared/run/run.h"

namespace ngs::cli {

/// The boundary Gaussians of a labelled PLY; with several objects, of their union. Throws kBadInput if the PLY has no
/// ngs_boundary, and kNothingFound if the set is empty (unless --allow-empty).
BoundarySet boundary_of(Run& run, const io::GaussianPly& ply, const std::string& path);

}  // namespace ngs::cli
