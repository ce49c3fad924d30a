#include "ngs/cut/training/first_queries.h"

#include <cmath>
#include <utility>

#include "ngs/core/error.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs {

std::vector<float> boundary_flags(const Problem& input, bool boundary_effect) {
  std::vector<float> flags(std::size_t(input.cloud.size()), 0.f);
  for (const LabelColumns& object : input.labels)
    for (std::size_t i = 0; i < flags.size(); ++i)
      if (boundary_effect ? is_set(object.boundary[i]) : object.views[i] > 0.f) flags[i] = 1.f;
  return flags;
}

void require_grids(const QueryField& field, const GaussianCloud& cloud, const std::string& name) {
  const auto bad = [&](const std::string& what) {
    throw Error(ErrorCode::kBadInput, name + ": " + what,
                "sample again: ngs-sample scene.json boundary.ply -o queries.ply");
  };
  const auto n = std::size_t(field.size());
  const std::pair<std::size_t, const char*> columns[] = {{field.uv.size() / 2, "u v"},
                                                         {field.view.size(), "view"},
                                                         {field.slot.size(), "slot"},
                                                         {field.depth.size(), "depth"}};
  for (const auto& [rows, column] : columns)
    if (rows != n) bad(std::string("no columns ") + column + ", expected those of ngs-sample");
  require_same_origin(field, cloud.origin);
  std::int32_t slot = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::int32_t before = i > 0 ? field.view[i - 1] : -1, view = field.view[i];
    slot = view == before ? slot + 1 : 0;
    if (view < before || field.slot[i] != slot)
      bad("row " + std::to_string(i) + " is slot " + std::to_string(field.slot[i]) + " of view " +
          std::to_string(view) + ", expected view by view all slots from 0");
    if (!std::isfinite(field.uv[2 * i]) || !std::isfinite(field.uv[2 * i + 1]) || !(field.depth[i] > 0))
      bad("row " + std::to_string(i) + " has no pixel or no depth, expected finite u v and depth > 0");
  }
}

FieldRays FirstQueries::rays(std::size_t v) const {
  const Camera& world = input.scene.views[v].camera;
  const Camera camera = relative_to(world, input.cloud.origin);
  const BoundarySet initial = boundary_set(input.cloud, boundary_flags(input, boundary_effect));
  if (given == nullptr) {
    Monitor quiet;
    QueryField sampled = sample_queries(exec, quiet, sample, {input.cloud, initial, input.scene, {v}, splat});
    interpolate_features(exec, quiet, rbf, initial, sampled);
    return field.rays(exec, camera, sampled, 0, initial);
  }
  for (std::size_t i = 0; i < given->views.size(); ++i)
    if (given->views[i].name == world.name) return field.rays(exec, camera, *given, i, initial);
  throw Error(ErrorCode::kInconsistent, "the field has no view '" + world.name + "', expected every training view",
              "sample again: ngs-sample scene.json boundary.ply --views all -o queries.ply");
}

}  // namespace ngs
