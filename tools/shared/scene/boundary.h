#pragma once
// What ngs-sample, ngs-rbf and ngs-joint ask of the PLY that ngs-variance writes.
#include <string>

#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/scene/boundary_set.h"
#include "shared/run/run.h"

namespace ngs::cli {

/// The boundary Gaussians of a labelled PLY (of several objects: of their union). kBadInput where the PLY has
/// no ngs_boundary; kNothingFound where the set is empty, unless --allow-empty.
BoundarySet boundary_of(Run& run, const io::GaussianPly& ply, const std::string& path);

}  // namespace ngs::cli
