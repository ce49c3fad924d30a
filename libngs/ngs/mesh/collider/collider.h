#pragma once
// Convex parts around a closed mesh, for physics engines.
#include <string>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/scene/triangle_mesh.h"

namespace ngs::mesh {

enum class ColliderKind : std::uint8_t { kBox, kHull, kConvex };

struct ColliderChoice {
  ColliderKind kind = ColliderKind::kHull;
  int parts = 1;  ///< of kConvex at most
};
/// "box", "hull", or "convex:N" with N in [1, 1024]. Throws kUsage for anything else.
ColliderChoice collider_choice(const std::string& text);

struct Collider {
  std::vector<TriangleMesh>
      parts;                    ///< convex, closed, in the world of the mesh; at most kColliderCorners vertices each
  double mesh_volume = 0;       ///< world^3
  double outside_share = 0;     ///< volume of the parts' union outside the mesh, of the mesh's volume
  double missing_share = 0;     ///< volume of the mesh outside all parts, of the mesh's volume
  double outside_distance = 0;  ///< world: greatest distance from the mesh of a place in a part
};

/// Corners of a hull that engines take (PhysX: 64 on a GPU).
inline constexpr std::size_t kColliderCorners = 64;

/// Computes the parts and their errors: added and missing volume by about 200,000 rays at most, distance at about
/// 100,000 places. kBox contains the whole mesh; hull vertices lie on the mesh, or inside it where parts meet. The
/// result does not depend on exec.threads. Throws kNothingFound for a mesh without faces, kInconsistent if the mesh is
/// open, has inward faces or encloses no volume, kNumeric for vertices that are not finite.
Collider make_collider(const Exec& exec, const TriangleMesh& mesh, const ColliderChoice& choice);

}  // namespace ngs::mesh
