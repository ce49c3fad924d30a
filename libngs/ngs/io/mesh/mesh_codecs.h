#pragma once
// The bytes of a mesh in each format, as they are: mesh_file.h places it. Colours are optional.
#include <string>

#include "ngs/io/mesh/rigid_body.h"

namespace ngs::io {

std::string encode_mesh_glb(const TriangleMesh& mesh);
std::string encode_rigid_glb(const RigidBody& body, ColliderNames names);
std::string encode_mesh_obj(const TriangleMesh& mesh);
std::string encode_mesh_ply(const TriangleMesh& mesh);
std::string encode_mesh_stl(const TriangleMesh& mesh);

/// "00", "01", ..., "99", "100".
std::string number_of_part(std::size_t k);

/// Appends a value's bytes, little-endian as all processors that ngs supports.
template <class T>
void append_bytes(const T& value, std::string& to) {
  to.append(reinterpret_cast<const char*>(&value), sizeof value);
}

inline std::uint8_t colour_byte(float value) {
  return std::uint8_t(value > 0 ? (value < 1 ? value * 255.f + 0.5f : 255.f) : 0.f);
}

}  // namespace ngs::io
