#include "ngs/io/mesh/mesh_file.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/formats/axes.h"
#include "ngs/io/formats/write_only/usda_text.h"

namespace ngs::io {
namespace {

std::optional<MeshFormat> format_of(const std::string& path) {
  std::string name = path;
  std::ranges::transform(name, name.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
  if (name.ends_with(".glb")) return MeshFormat::kGlb;
  if (name.ends_with(".usda")) return MeshFormat::kUsda;
  if (name.ends_with(".obj")) return MeshFormat::kObj;
  if (name.ends_with(".ply")) return MeshFormat::kPly;
  if (name.ends_with(".stl")) return MeshFormat::kStl;
  const bool has_extension = name.find('.', name.find_last_of('/') + 1) != std::string::npos;
  return has_extension ? std::nullopt : std::optional(MeshFormat::kGlb);
}

std::string encoded(const TriangleMesh& mesh, const MeshPlacement& placement, MeshFormat format) {
  switch (format) {
    case MeshFormat::kGlb:
      return encode_rigid_glb({placed(mesh, placement, 1), {}, 0, to_splat(placement)}, ColliderNames::kKhr);
    case MeshFormat::kObj: return encode_mesh_obj(placed(mesh, placement, 1));
    case MeshFormat::kStl: return encode_mesh_stl(placed(mesh, placement, 2));
    case MeshFormat::kPly: return encode_mesh_ply(mesh);
    case MeshFormat::kUsda: break;
  }
  NGS_CHECK(false, "write_rigid_usda() writes .usda");
  return {};
}

/// -y is up after the first rotation; a turn about x brings it to y or z.
Mat3<double> rotation(const MeshPlacement& placement, int up_axis) {
  const Mat3<double> turn =
      up_axis == 1 ? Mat3<double>{{-1, 0, 0, 0, -1, 0, 0, 0, 1}} : Mat3<double>{{1, 0, 0, 0, 0, 1, 0, -1, 0}};
  return turn * rotation_to_minus_y(placement.up);
}

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

MeshFormat mesh_format(const std::string& path) {
  if (const auto format = format_of(path)) return *format;
  throw Error(ErrorCode::kUsage, path + ": no format of meshes, expected " + kMeshFormats, "name it object.glb");
}

TriangleMesh placed(TriangleMesh mesh, const MeshPlacement& placement, int up_axis) {
  const Mat3<double> all = rotation(placement, up_axis);
  for (Vec3<float>& v : mesh.vertices) {
    const Vec3<double> p = placement.unit * (all * Vec3<double>{double(v.x), double(v.y), double(v.z)});
    v = {float(p.x), float(p.y), float(p.z)};
  }
  return mesh;
}

Mat3<double> to_splat(const MeshPlacement& placement) {
  Mat3<double> back = transpose(rotation(placement, 1));
  for (double& x : back.m) x /= placement.unit;
  return back;
}

void write_mesh(const std::string& path, const TriangleMesh& mesh, const MeshPlacement& placement) {
  const MeshFormat format = mesh_format(path);
  write_file(path, with_context(path, [&] { return encoded(mesh, placement, format); }));
}

void write_rigid_glb(const std::string& path, const RigidBody& body, const MeshPlacement& placement,
                     ColliderNames names) {
  write_file(path, with_context(path, [&] { return encode_rigid_glb(placed_body(body, placement), names); }));
}

void write_rigid_usda(const std::string& path, const GaussianCloud& splat, const RigidBody& body,
                      const MeshPlacement& placement) {
  const RigidBody there = placed_body(body, placement);
  SplatSelection rows = select_rows(splat, {});
  rows.turn = placing(placement.up, placement.unit);
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
