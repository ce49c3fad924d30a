#pragma once
// A mesh compared with the solids that it should show, and a splat of discs on their surface.
#include <string>
#include <vector>

#include "ngs/make/synth/synth_scene.h"
#include "ngs/scene/gaussian_cloud.h"
#include "ngs/scene/triangle_mesh.h"

namespace ngs::test {

/// An object of a recipe by name.
synth::Object recipe_object(const std::string& recipe, const std::string& name);

/// Signed distance to the union of an object's solids.
double distance_to(const synth::Object& object, Vec3<double> p);
Vec3<double> normal_at(const synth::Object& object, Vec3<double> p);

/// The object's surface by marching cubes on its distance; `cells` along the longest side.
TriangleMesh true_mesh(const synth::Object& object, int cells);

struct MeshSample {
  Vec3<double> at{}, normal{};
};
/// `count` points spread over the area of a mesh.
std::vector<MeshSample> samples_of(const TriangleMesh& mesh, int count);

/// Opaque flat discs on the object's surface, coloured by its texture.
GaussianCloud splat_of(const synth::Object& object, int count);

struct MeshScore {
  double to_truth = 0;     // mean distance of the mesh to the true surface, where a camera sees it, world
  double from_truth = 0;   // mean distance of the true surface to the mesh, where a camera sees it, world
  double normal_deg = 0;   // mean angle between the normals, where a camera sees it
  double seen_within = 0;  // share of the seen true surface that is at most `near` from the mesh
  double iou = 0;          // of the volumes
};
/// `scene`: all solids, which hide the object from `cameras`; without cameras all of the surface counts.
MeshScore score_of(const TriangleMesh& mesh, const synth::AnalyticScene& scene, int object,
                   const std::vector<Camera>& cameras, double near);

}  // namespace ngs::test
