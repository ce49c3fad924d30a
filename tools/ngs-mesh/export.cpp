#include "export.h"

#include "ngs/mesh/collider/collider.h"
#include "ngs/mesh/measures.h"

namespace ngs::cli {

void check_export(const std::string& path, const ExportOptions& options) {
  const io::MeshFormat format = io::mesh_format(path);
  if (options.collider.empty()) return;
  mesh::collider_choice(options.collider);
  if (format != io::MeshFormat::kGlb && format != io::MeshFormat::kUsda)
    throw Error(ErrorCode::kUsage, path + ": this format holds no colliders, expected .glb or .usda",
                "name it object.glb, or leave out --collider");
}

void write_export(Run& run, const ExportTarget& target, const GaussianCloud& splat, TriangleMesh mesh,
                  const ExportOptions& options) {
  const auto& [path, placement] = target;
  const io::MeshFormat format = io::mesh_format(path);
  io::RigidBody body{std::move(mesh), {}, 0};
  body.mass = options.density * mesh::measures_of(body.mesh).volume * placement.unit * placement.unit * placement.unit;
  if (!options.collider.empty()) {
    const auto timed = run.monitor().scope("collider");
    mesh::Collider collider = mesh::make_collider(run.exec(), body.mesh, mesh::collider_choice(options.collider));
    run.result()["mass_kg"] = body.mass;
    run.result()["collider"] = {{"parts", collider.parts.size()},
                                {"outside_share", collider.outside_share},
                                {"missing_share", collider.missing_share},
                                {"outside_distance", collider.outside_distance}};
    body.colliders = std::move(collider.parts);
  }
  const auto timed = run.monitor().scope("write");
  if (format == io::MeshFormat::kUsda) return io::write_rigid_usda(path, splat, body, placement);
  if (!body.colliders.empty()) return io::write_rigid_glb(path, body, placement, options.collider_names);
  io::write_mesh(path, body.mesh, placement);
}

}  // namespace ngs::cli
