#include "shared/scene/boundary.h"

#include "ngs/core/error.h"

namespace ngs::cli {

BoundarySet boundary_of(Run& run, const io::GaussianPly& ply, const std::string& path) {
  if (ply.cloud.size() == 0)
    run.nothing_found(path + ": the model has no Gaussians, expected some",
                      "use a model with Gaussians: ngs-variance scene.json -o boundary.ply");
  if (ply.labels.boundary.size() != std::size_t(ply.cloud.size()))
    throw Error(ErrorCode::kBadInput,
                path + ": vertex property 'ngs_boundary' is missing, expected a PLY written by ngs-variance",
                "find the boundary first: ngs-variance scene.json -o boundary.ply");
  BoundarySet set = boundary_set(ply.cloud, ply.labels.boundary.values());
  run.result()["boundary"] = set.size();
  if (set.size() == 0)
    run.nothing_found(path + ": no boundary Gaussians, expected at least one",
                      "lower the threshold: ngs-variance scene.json -o boundary.ply --tau 0.4");
  return set;
}

}  // namespace ngs::cli
