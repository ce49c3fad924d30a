#pragma once
// Triangle meshes as .glb, .obj, .ply and .stl (docs/formats.md). Written only, complete or not at all.
//
// clang-format off
//   .glb  binary glTF 2.0: positions, normals and colours (linear, 16 bit) of one mesh, KHR_materials_unlit: the colours
//         of a splat include its light. Metres, y up
//   .obj  text: v x y z r g b, f; y up
//   .ply  binary: float x y z, uchar red green blue, faces; the axes and the unit of the splat
//   .stl  binary: normals and corners, no colours; z up, as printers expect it
// clang-format on
#include <string>

#include "ngs/scene/triangle_mesh.h"

namespace ngs::io {

inline constexpr const char* kMeshFormats = ".glb, .usda, .obj, .ply or .stl";

struct MeshPlacement {
  Vec3<double> up{0, -1, 0};  // of the splat's world, unit length
  double unit = 1;            // metres of a unit of the splat's world, > 0
};

enum class MeshFormat : std::uint8_t { kGlb, kUsda, kObj, kPly, kStl };
/// By the extension; a name without one is a .glb. Throws kUsage if it is none of kMeshFormats.
MeshFormat mesh_format(const std::string& path);

/// Writes the mesh in the format of its extension, but not .usda (rigid_body.h). All formats but .ply are turned until
/// the model's `up` is their own and scaled by `unit`. kUsage for a mesh that the format cannot hold, and as above.
void write_mesh(const std::string& path, const TriangleMesh& mesh, const MeshPlacement& placement);

/// The mesh in a frame whose `up_axis` (0 x, 1 y, 2 z) is up.
TriangleMesh placed(TriangleMesh mesh, const MeshPlacement& placement, int up_axis);
/// From a frame with y up to that of the splat.
Mat3<double> to_splat(const MeshPlacement& placement);

}  // namespace ngs::io
