#pragma once
// The surface of an object that was cut out of a splat, as a closed triangle mesh.
//
// Renders the object from all around, fuses depths and silhouettes in a sparse signed distance field, and extracts its
// surface. Space that no view reaches is inside; space that views see as empty is outside.
#include <cstdint>

#include "ngs/backend/exec.h"
#include "ngs/core/monitor.h"
#include "ngs/edit/fill/fill_surface.h"
#include "ngs/mesh/surface/iso_surface.h"
#include "ngs/options/field.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs::mesh {

struct MeshOptions {
  int faces = 50000;
  int resolution = 256;
  double least_piece = 0.01;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.faces, Field<int>{"faces", "", "Most faces of the mesh; 0: all of the extracted surface", 0, 100000000});
    visit(self.resolution, Field<int>{"resolution", "", "Cells along the longest side of the object", 16, 1024});
    visit(self.least_piece, Field<double>{"least_piece", "of the area",
                                          "Leave out separate pieces smaller than this, of the largest one", 0, 1});
  }
};

struct ObjectMesh {
  TriangleMesh mesh;  // watertight, coloured; in the world of the splat, relative to the model's origin
  PieceCounts pieces;
  std::size_t extracted_faces = 0;
  double cell = 0;  // world
};

/// The planes of `rest`, the other Gaussians of the scene, that an object stands on or against, relative to the
/// object's origin (edit/fill/fill_surface.h).
std::vector<FillSurface> planes_behind(const Exec& exec, const GaussianCloud& object, const GaussianCloud& rest,
                                       std::uint64_t seed);

/// `planes` close the base of the object; they are relative to the model's origin. Throws kNothingFound without an
/// opaque surface. The result does not depend on exec.threads.
ObjectMesh mesh_of(const Exec& exec, Monitor& monitor, const GaussianCloud& cloud, const MeshOptions& options,
                   const std::vector<FillSurface>& planes = {});

}  // namespace ngs::mesh
