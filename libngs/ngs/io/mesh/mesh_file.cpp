#include "ngs/io/mesh/mesh_file.h"

#include <algorithm>
#include <optional>

#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/formats/axes.h"
#include "ngs/io/mesh/mesh_codecs.h"

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
  NGS_CHECK(false, "rigid_body.h writes .usda");
  return {};
}

/// -y is up after the first rotation; a turn about x brings it to y or z.
Mat3<double> rotation(const MeshPlacement& placement, int up_axis) {
  const Mat3<double> turn =
      up_axis == 1 ? Mat3<double>{{-1, 0, 0, 0, -1, 0, 0, 0, 1}} : Mat3<double>{{1, 0, 0, 0, 0, 1, 0, -1, 0}};
  return turn * rotation_to_minus_y(placement.up);
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

}  // namespace ngs::io
