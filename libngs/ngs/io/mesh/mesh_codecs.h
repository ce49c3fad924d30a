#pragma once
// The bytes of a mesh in each format, as they are: mesh_file.h places it. Colours are optional.
#include <algorithm>
#include <string>
#include <vector>

#include "ngs/math/elementary.h"
#include "ngs/scene/triangle_mesh.h"

namespace ngs::io {

enum class ColliderNames : std::uint8_t {
  kKhr,     // KHR_physics_rigid_bodies (draft): motion of "object", a collider per child; viewers do not draw them
  kUnreal,  // UCX_object_00: Unreal makes them convex collisions of the mesh
  kGodot    // collider00-convcolonly: Godot makes them convex shapes
};

struct RigidBody {
  TriangleMesh mesh;
  std::vector<TriangleMesh> colliders;                 ///< convex
  double mass = 0;                                     ///< kg, > 0
  Mat3<double> to_splat{{1, 0, 0, 0, 1, 0, 0, 0, 1}};  ///< from this frame to that of the splat
};

/// `to_splat` is in the asset's extras, row by row.
std::string encode_rigid_glb(const RigidBody& body, ColliderNames names);
std::string encode_mesh_obj(const TriangleMesh& mesh);
std::string encode_mesh_ply(const TriangleMesh& mesh);
std::string encode_mesh_stl(const TriangleMesh& mesh);

/// "00", "01", ..., "99", "100".
inline std::string number_of_part(std::size_t k) { return (k < 10 ? "0" : "") + std::to_string(k); }

/// Appends a value's bytes, little-endian as all processors that ngs supports.
template <class T>
void append_bytes(const T& value, std::string& to) {
  to.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// sRGB to linear, 0 to 1: glTF's vertex colours and OpenUSD's displayColor are linear.
inline float linear_colour(float srgb) {
  const float x = std::clamp(srgb, 0.f, 1.f);
  return x <= 0.04045f ? x / 12.92f : exp_of(2.4f * log_of((x + 0.055f) / 1.055f));
}

inline std::uint8_t colour_byte(float value) {
  return std::uint8_t(value > 0 ? (value < 1 ? value * 255.f + 0.5f : 255.f) : 0.f);
}

}  // namespace ngs::io
