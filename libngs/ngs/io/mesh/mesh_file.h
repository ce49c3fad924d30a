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

#include "ngs/io/mesh/mesh_codecs.h"
#include "ngs/scene/gaussian_cloud.h"
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

/// Writes the mesh in the format of its extension, but not .usda (write_rigid_usda). All formats but .ply are turned
/// until the model's `up` is their own and scaled by `unit`. kUsage for a mesh that the format cannot hold, and as
/// above.
void write_mesh(const std::string& path, const TriangleMesh& mesh, const MeshPlacement& placement);

/// The mesh in a frame whose `up_axis` (0 x, 1 y, 2 z) is up.
TriangleMesh placed(TriangleMesh mesh, const MeshPlacement& placement, int up_axis);
/// From a frame with y up to that of the splat.
Mat3<double> to_splat(const MeshPlacement& placement);

// A rigid body for engines and simulators: a mesh, its convex colliders and its mass, as .glb and .usda.
//
// clang-format off
//   .usda  Xform "Object" with PhysicsRigidBodyAPI and PhysicsMassAPI; in it the splat (ParticleField3DGaussianSplat), the
//          mesh with purpose "guide", and a Mesh per collider with PhysicsCollisionAPI and PhysicsMeshCollisionAPI
//          (approximation "convexHull"). Metres, kilograms, y up
//   .glb   node "object" with the mesh; its children are the colliders, named as an engine reads them (ColliderNames)
// clang-format on

/// Writes a .glb, turned and scaled as by write_mesh(). Throws as that.
void write_rigid_glb(const std::string& path, const RigidBody& body, const MeshPlacement& placement,
                     ColliderNames names);

/// Writes a .usda with the usable Gaussians of the splat, turned and scaled like the meshes.
void write_rigid_usda(const std::string& path, const GaussianCloud& splat, const RigidBody& body,
                      const MeshPlacement& placement);

}  // namespace ngs::io
