#pragma once
// A rigid body for engines and simulators: a mesh, its convex colliders and its mass, as .glb and .usda.
//
// clang-format off
//   .usda  Xform "Object" with PhysicsRigidBodyAPI and PhysicsMassAPI; in it the splat (ParticleField3DGaussianSplat), the
//          mesh with purpose "guide", and a Mesh per collider with PhysicsCollisionAPI and PhysicsMeshCollisionAPI
//          (approximation "convexHull"). Metres, kilograms, y up
//   .glb   node "object" with the mesh; its children are the colliders, named as an engine reads them (ColliderNames)
// clang-format on
#include <string>

#include "ngs/io/mesh/mesh_codecs.h"
#include "ngs/io/mesh/mesh_file.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs::io {

/// Writes a .glb, turned and scaled as by write_mesh(). Throws as that.
void write_rigid_glb(const std::string& path, const RigidBody& body, const MeshPlacement& placement,
                     ColliderNames names);

/// Writes a .usda with the usable Gaussians of the splat, turned and scaled like the meshes.
void write_rigid_usda(const std::string& path, const GaussianCloud& splat, const RigidBody& body,
                      const MeshPlacement& placement);

}  // namespace ngs::io
