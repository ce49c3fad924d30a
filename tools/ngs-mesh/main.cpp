// ngs-mesh: a closed triangle mesh of an object that was cut out of a splat.
#include "export.h"
#include "ngs/core/formatted.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/mesh/measures.h"
#include "ngs/mesh/surface/surface_stage.h"
#include "ngs/orbit/orbit_stage.h"
#include "ngs/scene/precision/local_origin.h"
#include "shared/tool.h"

namespace {

using namespace ngs;

void report(cli::Run& run, const mesh::ObjectMesh& object) {
  const mesh::MeshMeasures measures = mesh::measures_of(object.mesh);
  Json& result = run.result();
  result["vertices"] = object.mesh.vertices.size();
  result["faces"] = object.mesh.faces.size();
  result["extracted_faces"] = object.extracted_faces;
  result["pieces"] = object.pieces.kept;
  result["crumbs_left_out"] = object.pieces.crumbs;
  result["cavities_filled"] = object.pieces.cavities;
  result["border_edges"] = measures.border_edges;
  result["non_manifold_edges"] = measures.non_manifold_edges;
  result["volume"] = measures.volume;
  result["area"] = measures.area;
  result["cell"] = object.cell;
  if (object.pieces.kept > 1)
    run.monitor().warn("the mesh has " + std::to_string(object.pieces.kept) +
                       " separate pieces; --least-piece 1 keeps only the largest");
}

/// Adds the model's origin, unless float would round the positions.
void place_in_world(cli::Run& run, const GaussianCloud& cloud, TriangleMesh& mesh) {
  const auto& [x, y, z] = cloud.origin;
  if (needs_local_origin(cloud))
    return run.info("the mesh is relative to " + formatted("%.10g", x) + "," + formatted("%.10g", y) + "," +
                    formatted("%.10g", z) + ": float would round its world coordinates");
  for (Vec3<float>& v : mesh.vertices) v = {float(v.x + x), float(v.y + y), float(v.z + z)};
}

}  // namespace

int main(int argc, char** argv) {
  cli::Tool tool(
      "ngs-mesh", "Make a closed triangle mesh of an object that was cut out of a splat.",
      {"ngs-mesh object.ply -o object.glb", "ngs-mesh object.ply -o object.stl --faces 20000 --up z --unit 0.1",
       "ngs-mesh object.ply -o object.usda --collider convex:16 --density 700"});
  mesh::MeshOptions options;
  cli::ExportOptions placement;
  tool.options(options);
  tool.options(placement);
  const cli::Input& model =
      tool.input("model", "3DGS model of one object (.ply, .spz, .sog, .splat, .ksplat, .glb), such as object.ply");
  const cli::Input& rest = tool.optional_input(
      "--background", "the rest of the scene, such as background.ply: the object is closed where it stands on it");
  const cli::Output& out = tool.output("-o,--output", "the mesh: .glb, .usda, .obj, .ply or .stl");

  return tool.run(argc, argv, [&](cli::Run& run) {
    if (out) cli::check_export(out.path, placement);
    const io::GaussianPly ply = [&] {
      const auto timed = run.monitor().scope("read");
      return io::read_gaussian_ply(model.path);
    }();
    for (const std::string& note : ply.notes) run.info(note);
    if (ply.health.excluded() > 0)
      run.monitor().warn(std::to_string(ply.health.excluded()) +
                         " Gaussians have values that are not finite or out of range: they are left out");
    run.result()["gaussians"] = ply.cloud.size();
    if (run.dry_run()) {
      run.plan({{"gaussians", ply.cloud.size()}, {"resolution", options.resolution}});
      return cli::kDone;
    }
    std::vector<FillSurface> planes;
    if (rest) {
      const auto timed = run.monitor().scope("planes");
      planes = mesh::planes_behind(run.exec(), ply.cloud, io::read_gaussian_ply(rest.path).cloud, run.seed());
      run.result()["planes"] = planes.size();
    }
    mesh::ObjectMesh object = mesh::mesh_of(run.exec(), run.monitor(), ply.cloud, options, planes);
    report(run, object);
    place_in_world(run, ply.cloud, object.mesh);
    const cli::ExportTarget target{out.path, {orbit::axis_of(up_or(placement.up, ply.vertical_axis)), placement.unit}};
    cli::write_export(run, target, ply.cloud, std::move(object.mesh), placement);
    return cli::kDone;
  });
}
