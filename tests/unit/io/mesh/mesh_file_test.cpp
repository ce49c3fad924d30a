#include "ngs/io/mesh/mesh_file.h"

#include <doctest/doctest.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <sstream>

#include "ngs/core/error.h"
#include "ngs/io/ply/ply.h"
#include "support/error_code.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

/// A tetrahedron whose long edge is up in a model with -y up.
TriangleMesh tetrahedron() {
  return {.vertices = {{0, 0, 0}, {1, 0, 0}, {0, -3, 0}, {0, 0, 1}},
          .faces = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}},
          .colours = {{1, 0, 0}, {0, 0.5f, 0}, {0, 0, 1}, {1, 1, 1}}};
}

template <class T>
T value_at(const std::string& bytes, std::size_t at) {
  T value;
  REQUIRE(at + sizeof value <= bytes.size());
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

TEST_CASE("a .glb has the mesh with y up in metres, unit normals and linear colours") {
  const test::TempDir folder;
  const std::string path = folder.path() + "/m.glb";
  io::write_mesh(path, tetrahedron(), {.unit = 0.5});
  const std::string bytes = test::read_bytes(path);
  CHECK(bytes.substr(0, 4) == "glTF");
  CHECK(value_at<std::uint32_t>(bytes, 8) == bytes.size());
  const auto text = value_at<std::uint32_t>(bytes, 12);
  const auto gltf = nlohmann::json::parse(bytes.substr(20, text));
  const std::string buffer = bytes.substr(28 + text);
  CHECK(gltf["buffers"][0]["byteLength"] == buffer.size());
  const auto& primitive = gltf["meshes"][0]["primitives"][0];
  const auto begin_of = [&](const nlohmann::json& accessor) {
    return gltf["bufferViews"][gltf["accessors"][accessor.get<int>()]["bufferView"].get<int>()]["byteOffset"]
        .get<std::size_t>();
  };
  const std::size_t at = begin_of(primitive["attributes"]["POSITION"]);
  CHECK(value_at<Vec3<float>>(buffer, at + 24).y == doctest::Approx(1.5));
  CHECK(gltf["accessors"][0]["max"][1] == 1.5);
  Mat3<double> back;
  for (std::size_t k = 0; k < 9; ++k) back.m[k] = gltf["asset"]["extras"]["to_splat"][k];
  for (std::uint32_t v = 0; v < 4; ++v) {
    const auto p = value_at<Vec3<float>>(buffer, at + 12 * v);
    CHECK(length(back * Vec3<double>{double(p.x), double(p.y), double(p.z)} - tetrahedron().at(v)) < 1e-6);
  }
  const std::size_t normals = begin_of(primitive["attributes"]["NORMAL"]);
  for (std::size_t v = 0; v < 4; ++v) {
    const auto n = value_at<Vec3<float>>(buffer, normals + 12 * v);
    CHECK(n.x * n.x + n.y * n.y + n.z * n.z == doctest::Approx(1));
  }
  const std::size_t colours = begin_of(primitive["attributes"]["COLOR_0"]);
  CHECK(value_at<std::uint16_t>(buffer, colours) == 65535);
  CHECK(value_at<std::uint16_t>(buffer, colours + 10) == doctest::Approx(0.21404 * 65535).epsilon(1e-3));  // of 0.5
  const std::size_t indices = begin_of(primitive["indices"]);
  CHECK(gltf["accessors"][primitive["indices"].get<int>()]["count"] == 12);
  CHECK(value_at<std::uint32_t>(buffer, indices + 4) == 1);
}

TEST_CASE("an .obj and a .stl have the same triangles, y up and z up") {
  const test::TempDir folder;
  io::write_mesh(folder.path() + "/m.obj", tetrahedron(), {});
  std::istringstream lines(test::read_bytes(folder.path() + "/m.obj"));
  std::string line;
  std::vector<std::string> vertices, faces;
  while (std::getline(lines, line)) {
    if (line.starts_with("v ")) vertices.push_back(line);
    if (line.starts_with("f ")) faces.push_back(line);
  }
  REQUIRE(vertices.size() == 4);
  CHECK(vertices[1].ends_with(" 0 0.5 0"));
  CHECK(vertices[2].find(" 3 ") != std::string::npos);
  REQUIRE(faces.size() == 4);
  CHECK(faces[3] == "f 2 4 3");
  io::write_mesh(folder.path() + "/m.STL", tetrahedron(), {});
  const std::string stl = test::read_bytes(folder.path() + "/m.STL");
  REQUIRE(stl.size() == 84 + 4 * 50);
  CHECK(!stl.starts_with("solid"));
  CHECK(value_at<std::uint32_t>(stl, 80) == 4);
  CHECK(value_at<Vec3<float>>(stl, 84 + 36).z == doctest::Approx(3));  // the third corner of the first face
}

TEST_CASE("a .ply has the splat's axes, unit and byte colours") {
  const test::TempDir folder;
  const std::string path = folder.path() + "/m.ply";
  io::write_mesh(path, tetrahedron(), {.up = {0, 0, 1}, .unit = 7});
  const io::PlyFile file = io::PlyFile::open(path);
  const io::PlyElement* vertex = file.find("vertex");
  REQUIRE(vertex != nullptr);
  CHECK(vertex->count == 4);
  const io::PlyElement* face = file.find("face");
  REQUIRE(face != nullptr);
  CHECK(face->count == 4);
  const std::string bytes = test::read_bytes(path);
  const std::size_t body = bytes.find("end_header\n") + 11;
  CHECK(value_at<Vec3<float>>(bytes, body + 2 * 15).y == -3);
  CHECK(value_at<std::uint8_t>(bytes, body + 15 + 13) == 128);
  CHECK(value_at<std::uint8_t>(bytes, body + 4 * 15) == 3);
  CHECK(value_at<std::uint32_t>(bytes, body + 4 * 15 + 13 + 5) == 3);
}

TEST_CASE("a mesh without faces is a valid file, an unknown extension is refused before anything is written") {
  const test::TempDir folder;
  for (const char* name : {"/m.glb", "/m.obj", "/m.ply", "/m.stl"}) io::write_mesh(folder.path() + name, {}, {});
  CHECK(test::read_bytes(folder.path() + "/m.glb").size() > 20);
  CHECK(test::code_of([&] { io::write_mesh(folder.path() + "/m.fbx", tetrahedron(), {}); }) == ErrorCode::kUsage);
  CHECK(test::read_bytes(folder.path() + "/m.fbx").empty());
}

}  // namespace
}  // namespace ngs
