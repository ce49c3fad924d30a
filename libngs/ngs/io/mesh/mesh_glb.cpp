// Binary glTF of a triangle mesh.
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "ngs/core/error.h"
#include "ngs/core/version.h"
#include "ngs/io/mesh/mesh_codecs.h"

namespace ngs::io {
namespace {

using nlohmann::ordered_json;

// glTF constants
constexpr int kFloat = 5126, kUnsignedShort = 5123, kUnsignedInt = 5125, kArrayBuffer = 34962, kIndexBuffer = 34963;
constexpr std::uint32_t kMagic = 0x46546c67, kVersion2 = 2, kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;
constexpr std::size_t kMaxBytes = 0xf0000000;

std::uint16_t linear16(float srgb) { return std::uint16_t(std::lround(linear_colour(srgb) * 65535.f)); }

struct Buffer {
  std::string bytes;
  ordered_json views = ordered_json::array(), accessors = ordered_json::array();

  /// Describes what was appended since `begin` and returns the accessor's number.
  std::size_t add(std::size_t begin, std::size_t count, int component, const char* type, int target) {
    views.push_back({{"buffer", 0}, {"byteOffset", begin}, {"byteLength", bytes.size() - begin}, {"target", target}});
    accessors.push_back(
        {{"bufferView", views.size() - 1}, {"componentType", component}, {"count", count}, {"type", type}});
    return accessors.size() - 1;
  }
};

void add_bounds(const TriangleMesh& mesh, ordered_json& accessor) {
  Vec3<float> low = mesh.vertices[0], high = low;
  for (const Vec3<float> v : mesh.vertices) {
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
    high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
  }
  accessor["min"] = {low.x, low.y, low.z};
  accessor["max"] = {high.x, high.y, high.z};
}

ordered_json attributes_of(const TriangleMesh& mesh, Buffer& buffer) {
  const std::size_t count = mesh.vertices.size();
  std::size_t begin = buffer.bytes.size();
  for (const Vec3<float> v : mesh.vertices) append_bytes(v, buffer.bytes);
  ordered_json attributes;
  attributes["POSITION"] = buffer.add(begin, count, kFloat, "VEC3", kArrayBuffer);
  add_bounds(mesh, buffer.accessors.back());
  begin = buffer.bytes.size();
  for (const Vec3<float> n : vertex_normals(mesh)) append_bytes(n, buffer.bytes);
  attributes["NORMAL"] = buffer.add(begin, count, kFloat, "VEC3", kArrayBuffer);
  if (mesh.colours.empty()) return attributes;
  begin = buffer.bytes.size();
  for (const Vec3<float> c : mesh.colours)
    append_bytes(std::array<std::uint16_t, 4>{linear16(c.x), linear16(c.y), linear16(c.z), 65535}, buffer.bytes);
  attributes["COLOR_0"] = buffer.add(begin, count, kUnsignedShort, "VEC4", kArrayBuffer);
  buffer.accessors.back()["normalized"] = true;
  return attributes;
}

std::size_t add_indices(const TriangleMesh& mesh, Buffer& buffer) {
  const std::size_t begin = buffer.bytes.size();
  for (const auto& face : mesh.faces) append_bytes(face, buffer.bytes);
  return buffer.add(begin, 3 * mesh.faces.size(), kUnsignedInt, "SCALAR", kIndexBuffer);
}

/// Adds the colliders as children of the first node; `names` says how.
void add_colliders(const RigidBody& body, ColliderNames names, Buffer& buffer, ordered_json& gltf) {
  constexpr const char* kPhysics = "KHR_physics_rigid_bodies";
  if (names == ColliderNames::kKhr) {
    gltf["extensionsUsed"].push_back(kPhysics);
    gltf["nodes"][0]["extensions"][kPhysics]["motion"]["mass"] = body.mass;
  }
  for (std::size_t k = 0; k < body.colliders.size(); ++k) {
    const TriangleMesh& part = body.colliders[k];
    ordered_json primitive;
    const std::size_t begin = buffer.bytes.size();
    for (const Vec3<float> v : part.vertices) append_bytes(v, buffer.bytes);
    primitive["attributes"]["POSITION"] = buffer.add(begin, part.vertices.size(), kFloat, "VEC3", kArrayBuffer);
    add_bounds(part, buffer.accessors.back());
    primitive["indices"] = add_indices(part, buffer);
    ordered_json node = {{"name", names == ColliderNames::kUnreal  ? "UCX_object_" + number_of_part(k)
                                  : names == ColliderNames::kGodot ? "collider" + number_of_part(k) + "-convcolonly"
                                                                   : "collider" + number_of_part(k)}};
    gltf["nodes"][0]["children"].push_back(gltf["nodes"].size());
    ordered_json mesh = {{"name", node["name"]}};
    mesh["primitives"].push_back(primitive);
    if (names == ColliderNames::kKhr) {  // the shape is a node outside the scene, so that it is not drawn
      const std::size_t shape = gltf["nodes"].size() + 1;
      node["extensions"][kPhysics]["collider"]["geometry"] = {{"node", shape}, {"convexHull", true}};
      gltf["nodes"].push_back(node);
      gltf["nodes"].push_back({{"mesh", gltf["meshes"].size()}, {"name", "shape" + number_of_part(k)}});
    } else {
      node["mesh"] = gltf["meshes"].size();
      gltf["nodes"].push_back(node);
    }
    gltf["meshes"].push_back(mesh);
  }
}

ordered_json description_of(const RigidBody& body, ColliderNames names, Buffer& buffer) {
  const TriangleMesh& mesh = body.mesh;
  ordered_json gltf = {{"asset", {{"version", "2.0"}, {"generator", std::string("ngs ") + kVersion}}}, {"scene", 0}};
  gltf["asset"]["extras"]["to_splat"] = body.to_splat.m;
  if (mesh.faces.empty()) {
    gltf["scenes"] = ordered_json::array({ordered_json::object()});
    return gltf;
  }
  gltf["extensionsUsed"] = ordered_json::array({"KHR_materials_unlit"});
  ordered_json primitive;
  primitive["attributes"] = attributes_of(mesh, buffer);
  primitive["indices"] = add_indices(mesh, buffer);
  primitive["material"] = 0;
  ordered_json material = {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}}};
  material["extensions"]["KHR_materials_unlit"] = ordered_json::object();
  ordered_json scene, object;
  scene["nodes"].push_back(0);
  object["primitives"].push_back(primitive);
  gltf["scenes"].push_back(scene);
  gltf["nodes"].push_back(ordered_json{{"mesh", 0}, {"name", "object"}});
  object["name"] = "object";
  gltf["meshes"].push_back(object);
  gltf["materials"].push_back(material);
  if (!body.colliders.empty()) add_colliders(body, names, buffer, gltf);
  gltf["accessors"] = buffer.accessors;
  gltf["bufferViews"] = buffer.views;
  gltf["buffers"].push_back(ordered_json{{"byteLength", buffer.bytes.size()}});
  return gltf;
}

}  // namespace

std::string encode_rigid_glb(const RigidBody& body, ColliderNames names) {
  const TriangleMesh& mesh = body.mesh;
  if (32 * mesh.vertices.size() + 12 * mesh.faces.size() > kMaxBytes)
    throw Error(ErrorCode::kUsage, std::to_string(mesh.faces.size()) + " faces, a .glb holds less than 4 GiB",
                "simplify it with --faces 100000");
  Buffer buffer;
  std::string text = description_of(body, names, buffer).dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const bool is_empty = buffer.bytes.empty();
  const std::size_t total = 12 + 8 + text.size() + (is_empty ? 0 : 8 + buffer.bytes.size());
  std::string bytes;
  for (const std::uint32_t word : {kMagic, kVersion2, std::uint32_t(total), std::uint32_t(text.size()), kJsonChunk})
    append_bytes(word, bytes);
  bytes += text;
  if (is_empty) return bytes;
  append_bytes(std::uint32_t(buffer.bytes.size()), bytes);
  append_bytes(kBinaryChunk, bytes);
  return bytes + buffer.bytes;
}

}  // namespace ngs::io
