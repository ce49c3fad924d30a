#include "ngs/stages/first_queries.h"

#include "ngs/core/error.h"

namespace ngs {

std::vector<float> boundary_flags(const MethodInput& input, bool boundary_effect) {
  std::vector<float> flags(std::size_t(input.cloud.size()), 0.f);
  for (const LabelColumns& object : input.labels)
    for (std::size_t i = 0; i < flags.size(); ++i)
      if (boundary_effect ? object.boundary[i] >= 0.5f : object.views[i] > 0.f) flags[i] = 1.f;
  return flags;
}

FieldRays FirstQueries::rays(std::size_t v) const {
  const Camera& world = input.scene.views[v].camera;
  const Camera camera = relative_to(world, input.cloud.origin);
  const BoundarySet initial = boundary_set(input.cloud, boundary_flags(input, boundary_effect));
  if (given == nullptr) {
    Monitor quiet;
    QueryField sampled = sample_queries(exec, quiet, sample, input.cloud, initial, input.scene, {v}, input.splat);
    interpolate_features(exec, quiet, rbf, input.cloud, initial, sampled);
    return field.rays(exec, camera, sampled, 0, initial);
  }
  for (std::size_t i = 0; i < given->views.size(); ++i)
    if (given->views[i].name == world.name) return field.rays(exec, camera, *given, i, initial);
  throw Error(ErrorCode::kInconsistent, "the field has no view '" + world.name + "', expected every training view",
              "sample again: ngs-sample scene.json boundary.ply --views all -o queries.ply");
}

}  // namespace ngs
