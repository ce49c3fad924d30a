#pragma once
// The options and the output of ngs-mesh: a mesh, or a rigid body with colliders and mass.
#include "ngs/io/mesh/mesh_file.h"
#include "ngs/orbit/orbit_options.h"
#include "shared/tool.h"

namespace ngs::cli {

inline constexpr NamedValue<io::ColliderNames> kColliderNames[] = {
    {io::ColliderNames::kKhr, "khr"}, {io::ColliderNames::kUnreal, "unreal"}, {io::ColliderNames::kGodot, "godot"}};

struct ExportOptions {
  UpAxis up = UpAxis::kAuto;
  double unit = 1;
  std::string collider;
  double density = 1000;
  io::ColliderNames collider_names = io::ColliderNames::kKhr;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.up,
          Choice<UpAxis>{"up", "Axis of the model that points upwards; auto: the one that its file names, else -y",
                         kUpNames});
    visit(self.unit, Field<double>{"unit", "m", "Length of a unit of the model, for all formats but .ply", 1e-9, 1e9});
    visit(self.collider,
          Text{"collider", "KIND",
               "Add colliders to a .glb or .usda: convex:N makes at most N convex parts, hull the convex "
               "hull, box the smallest box; empty: none"});
    visit(self.density, Field<double>{"density", "kg/m^3",
                                      "Density of the object, which gives its mass in .glb and .usda", 1e-3, 1e6});
    visit(self.collider_names, Choice<io::ColliderNames>{
                                   "collider_names", "Engine whose names the colliders of a .glb get", kColliderNames});
  }
};

/// Throws kUsage for a name whose format is unknown or holds no colliders, and for colliders of no known kind.
void check_export(const std::string& path, const ExportOptions& options);

struct ExportTarget {
  std::string path;
  io::MeshPlacement placement;
};

/// Makes the colliders, reports them and writes everything. `splat`: what a .usda holds in addition to the mesh.
void write_export(Run& run, const ExportTarget& target, const GaussianCloud& splat, TriangleMesh mesh,
                  const ExportOptions& options);

}  // namespace ngs::cli
