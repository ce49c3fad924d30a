// The formats of a mesh that need no description of their contents: .obj, .ply, .stl.
#include <charconv>

#include "ngs/core/version.h"
#include "ngs/io/mesh/mesh_codecs.h"

namespace ngs::io {
namespace {

constexpr std::size_t kStlHeader = 80;

void add_number(float value, std::string& text) {
  char digits[24];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

void add_vector(Vec3<float> v, std::string& text) {
  for (const float value : {v.x, v.y, v.z}) {
    text += ' ';
    add_number(value, text);
  }
}

}  // namespace

std::string encode_mesh_obj(const TriangleMesh& mesh) {
  std::string text = std::string("# ngs ") + kVersion + "\no object\n";
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    text += 'v';
    add_vector(mesh.vertices[v], text);
    if (!mesh.colours.empty()) add_vector(mesh.colours[v], text);
    text += '\n';
  }
  for (const auto& face : mesh.faces) {
    text += 'f';
    for (const std::uint32_t v : face) text += ' ' + std::to_string(v + 1);
    text += '\n';
  }
  return text;
}

std::string encode_mesh_ply(const TriangleMesh& mesh) {
  const bool coloured = !mesh.colours.empty();
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(mesh.vertices.size()) +
                      "\nproperty float x\nproperty float y\nproperty float z\n";
  if (coloured) bytes += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  bytes += "element face " + std::to_string(mesh.faces.size()) +
           "\nproperty list uchar uint vertex_indices\ncomment ngs " + kVersion + "\nend_header\n";
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    append_bytes(mesh.vertices[v], bytes);
    if (!coloured) continue;
    const Vec3<float> rgb = mesh.colours[v];
    for (const float value : {rgb.x, rgb.y, rgb.z}) append_bytes(colour_byte(value), bytes);
  }
  for (const auto& face : mesh.faces) {
    append_bytes(std::uint8_t(3), bytes);
    append_bytes(face, bytes);
  }
  return bytes;
}

std::string encode_mesh_stl(const TriangleMesh& mesh) {
  std::string bytes = std::string("ngs ") + kVersion;  // must not begin with "solid", as the text form does
  bytes.resize(kStlHeader, ' ');
  append_bytes(std::uint32_t(mesh.faces.size()), bytes);
  for (const auto& [a, b, c] : mesh.faces) {
    const Vec3<double> n = unit(cross(mesh.at(b) - mesh.at(a), mesh.at(c) - mesh.at(a)));
    append_bytes(Vec3<float>{float(n.x), float(n.y), float(n.z)}, bytes);
    for (const std::uint32_t v : {a, b, c}) append_bytes(mesh.vertices[v], bytes);
    append_bytes(std::uint16_t(0), bytes);
  }
  return bytes;
}

}  // namespace ngs::io
