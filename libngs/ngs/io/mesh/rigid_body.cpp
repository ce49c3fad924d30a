#include "ngs/io/mesh/rigid_body.h"

#include <cmath>

#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/formats/axes.h"
#include "ngs/io/formats/write_only/usda_text.h"

namespace ngs::io {
namespace {

RigidBody placed_body(const RigidBody& body, const MeshPlacement& placement) {
  RigidBody result{placed(body.mesh, placement, 1), {}, body.mass, to_splat(placement)};
  for (const TriangleMesh& part : body.colliders) result.colliders.push_back(placed(part, placement, 1));
  return result;
}

/// A prim of a mesh that is not rendered; `schemas`: the line with its APIs, or empty.
void add_guide_mesh(const TriangleMesh& mesh, const std::string& name, const std::string& schemas, UsdaText& text) {
  text.add("def Mesh \"" + name + "\"" + schemas + "\n{\n");
  if (!schemas.empty()) text.add("    uniform token physics:approximation = \"convexHull\"\n");
  text.add("    uniform token purpose = \"guide\"\n    uniform token subdivisionScheme = \"none\"\n");
  text.add("    point3f[] points = ");
  add_usda_list(mesh.vertices, text);
  text.add("\n    int[] faceVertexCounts = ");
  add_usda_list(std::vector<std::uint32_t>(mesh.faces.size(), 3), text);
  text.add("\n    int[] faceVertexIndices = ");
  std::vector<std::uint32_t> corners;
  for (const auto& face : mesh.faces) corners.insert(corners.end(), face.begin(), face.end());
  add_usda_list(corners, text);
  text.add("\n");
  if (!mesh.colours.empty()) {
    std::vector<Vec3<float>> linear = mesh.colours;
    for (Vec3<float>& c : linear) c = {linear_colour(c.x), linear_colour(c.y), linear_colour(c.z)};
    text.add("    color3f[] primvars:displayColor = ");
    add_usda_list(linear, text);
    text.add(" (\n        interpolation = \"vertex\"\n    )\n");
  }
  text.add("}\n");
}

}  // namespace

void write_rigid_glb(const std::string& path, const RigidBody& body, const MeshPlacement& placement,
                     ColliderNames names) {
  write_file(path, with_context(path, [&] { return encode_rigid_glb(placed_body(body, placement), names); }));
}

void write_rigid_usda(const std::string& path, const GaussianCloud& splat, const RigidBody& body,
                      const MeshPlacement& placement) {
  const RigidBody there = placed_body(body, placement);
  SplatSelection rows = select_rows(splat, {});
  rows.turn = [rotation = RowRotation(rotation_to_minus_y(placement.up)), &placement](SplatRow& row) {
    rotation.apply(row);
    for (float& x : row.position) x = float(placement.unit * double(x));
    for (float& x : row.log_scale) x = float(double(x) + std::log(placement.unit));
  };
  UsdaText text;
  text.add_header("Object");
  text.add("def Xform \"Object\" (\n    prepend apiSchemas = [\"PhysicsRigidBodyAPI\", \"PhysicsMassAPI\"]\n)\n{\n");
  text.add("    float physics:mass = ");
  text.add(float(there.mass));
  text.add("\n\n");
  add_usda_splat(rows, text);
  text.add("\n");
  add_guide_mesh(there.mesh, "Mesh", "", text);
  for (std::size_t k = 0; k < there.colliders.size(); ++k) {
    text.add("\n");
    add_guide_mesh(there.colliders[k], "Collider" + number_of_part(k),
                   " (\n    prepend apiSchemas = [\"PhysicsCollisionAPI\", \"PhysicsMeshCollisionAPI\"]\n)", text);
  }
  text.add("}\n");
  const std::vector<std::uint8_t> bytes = std::move(text).take();
  write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace ngs::io
