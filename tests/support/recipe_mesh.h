#pragma once
// Closed meshes of the objects of analytic scenes.
#include <string>

#include "ngs/make/synth/synth_scene.h"
#include "ngs/scene/triangle_mesh.h"

namespace ngs::test {

/// An object of a recipe by name.
synth::Object recipe_object(const std::string& recipe, const std::string& object);
/// Signed distance to the union of its solids.
double distance(const synth::Object& object, Vec3<double> p);
/// Its surface, `cells` along the longest side.
TriangleMesh recipe_mesh(const std::string& recipe, const std::string& object, int cells);

inline Vec3<double> to_double(Vec3<float> v) { return {v.x, v.y, v.z}; }

}  // namespace ngs::test
