#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "ngs/io/mesh/mesh_file.h"
#include "support/splat_files.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

/// A prim of OpenUSD text.
struct Prim {
  std::string type, name, schemas;
  std::map<std::string, std::string> values;  // by "type name" of the attribute
  std::vector<Prim> children;

  const Prim& child(const std::string& wanted) const {
    const auto found = std::ranges::find(children, wanted, &Prim::name);
    REQUIRE(found != children.end());
    return *found;
  }
  /// All numbers of an attribute.
  std::vector<double> numbers(const std::string& attribute) const {
    REQUIRE(values.count(attribute) == 1);
    std::string text = values.at(attribute);
    for (char& c : text)
      if (std::string("[](),").find(c) != std::string::npos) c = ' ';
    std::istringstream words(text);
    std::vector<double> found;
    for (double x = 0; words >> x;) found.push_back(x);
    CHECK(words.eof());  // nothing but numbers
    return found;
  }
};

/// Reads what we write of OpenUSD text, and refuses all else: one attribute a line, `def TYPE "NAME"`, metadata in
/// parentheses, braces on lines of their own.
class UsdaReader {
 public:
  explicit UsdaReader(const std::string& text) : lines_(text) {}

  Prim read() {
    Prim root;
    REQUIRE(next() == "#usda 1.0");
    REQUIRE(next() == "(");
    root.schemas = metadata();
    while (next_if_any()) root.children.push_back(prim());
    return root;
  }

 private:
  std::string next() {
    REQUIRE(next_if_any());
    return line_;
  }
  bool next_if_any() {
    while (std::getline(lines_, line_)) {
      line_.erase(0, line_.find_first_not_of(' '));
      if (!line_.empty()) return true;
    }
    return false;
  }
  std::string metadata() {
    std::string all;
    while (next() != ")") all += line_ + "\n";
    return all;
  }
  Prim prim() {
    Prim prim;
    std::istringstream words(line_);
    std::string def, opening;
    words >> def >> prim.type >> prim.name >> opening;
    REQUIRE(def == "def");
    prim.name = prim.name.substr(1, prim.name.size() - 2);
    if (opening == "(") prim.schemas = metadata();
    REQUIRE(next() == "{");
    while (next() != "}") {
      if (line_.rfind("def ", 0) == 0) {
        prim.children.push_back(this->prim());
        continue;
      }
      const std::size_t equals = line_.find(" = ");
      REQUIRE(equals != std::string::npos);
      const std::string key = line_.substr(0, equals);
      std::string value = line_.substr(equals + 3);
      if (value.ends_with(" (")) {
        value.resize(value.size() - 2);
        prim.values.emplace(key + " metadata", metadata());
      }
      CHECK(prim.values.emplace(key, value).second);
    }
    return prim;
  }

  std::istringstream lines_;
  std::string line_;
};

/// A tetrahedron whose edge of length 3 is up in a model with z up, and two colliders.
io::RigidBody body() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 3}};
  mesh.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  TriangleMesh other = mesh;
  other.vertices[3].z = -3;
  for (auto& face : other.faces) std::swap(face[0], face[1]);
  io::RigidBody body{mesh, {mesh, other}, 2.5};
  body.mesh.colours = {{1, 0, 0}, {0, 0.5f, 0}, {0, 0, 1}, {1, 1, 1}};
  return body;
}
constexpr io::MeshPlacement kHalfMetres{{0, 0, 1}, 0.5};

TEST_CASE("a .usda has the body with its mass, the splat, a guide mesh and convex colliders, y up in metres") {
  const test::TempDir folder;
  GaussianCloud splat = test::plain_cloud(1, 0, 3);
  splat.position = {0, 0, 3};
  splat.log_scale = {0, 0, 0};
  io::write_rigid_usda(folder.file("b.usda"), splat, body(), kHalfMetres);
  const Prim root = UsdaReader(test::read_bytes(folder.file("b.usda"))).read();
  for (const char* line : {"defaultPrim = \"Object\"\n", "metersPerUnit = 1\n", "upAxis = \"Y\"\n"})
    CHECK(root.schemas.find(line) != std::string::npos);
  REQUIRE(root.children.size() == 1);
  const Prim& object = root.child("Object");
  CHECK(object.schemas == "prepend apiSchemas = [\"PhysicsRigidBodyAPI\", \"PhysicsMassAPI\"]\n");
  CHECK(object.numbers("float physics:mass") == std::vector<double>{2.5});
  CHECK(object.children.size() == 4);
  const Prim& splat_prim = object.child("Splat");
  CHECK(splat_prim.type == "ParticleField3DGaussianSplat");
  const std::vector<double> place = splat_prim.numbers("point3f[] positions");
  REQUIRE(place.size() == 3);
  CHECK(place[1] == doctest::Approx(1.5));
  CHECK(std::abs(place[0]) + std::abs(place[2]) < 1e-6);
  CHECK(splat_prim.numbers("float3[] scales")[0] == doctest::Approx(0.5));
  const Prim& mesh = object.child("Mesh");
  CHECK(mesh.schemas.empty());
  CHECK(mesh.values.at("uniform token purpose") == "\"guide\"");
  REQUIRE(mesh.numbers("color3f[] primvars:displayColor").size() == 12);
  CHECK(mesh.numbers("color3f[] primvars:displayColor")[4] == doctest::Approx(0.2140).epsilon(1e-3));  // linear
  CHECK(mesh.values.at("color3f[] primvars:displayColor metadata") == "interpolation = \"vertex\"\n");
  for (const char* name : {"Collider00", "Collider01"}) {
    const Prim& part = object.child(name);
    CHECK(part.type == "Mesh");
    CHECK(part.schemas == "prepend apiSchemas = [\"PhysicsCollisionAPI\", \"PhysicsMeshCollisionAPI\"]\n");
    CHECK(part.values.at("uniform token physics:approximation") == "\"convexHull\"");
    CHECK(part.numbers("int[] faceVertexCounts") == std::vector<double>(4, 3));
    const std::vector<double> corners = part.numbers("int[] faceVertexIndices");
    CHECK(corners.size() == 12);
    CHECK(*std::ranges::max_element(corners) == 3);
    CHECK(part.numbers("point3f[] points").size() == 12);
  }
  // The splat lies where the mesh has its tip.
  CHECK(mesh.numbers("point3f[] points")[10] == doctest::Approx(place[1]));
}

nlohmann::json gltf_of(io::ColliderNames names) {
  const test::TempDir folder;
  io::write_rigid_glb(folder.file("b.glb"), body(), kHalfMetres, names);
  const std::string bytes = test::read_bytes(folder.file("b.glb"));
  const auto text = bytes.find("JSON") + 4;
  return nlohmann::json::parse(bytes.substr(text, bytes.find_last_of('}', bytes.find("BIN")) + 1 - text));
}

TEST_CASE("a .glb has the colliders as children, named for the engine; those of KHR are not drawn") {
  const nlohmann::json khr = gltf_of(io::ColliderNames::kKhr);
  const auto& object = khr["nodes"][0];
  CHECK(object["extensions"]["KHR_physics_rigid_bodies"]["motion"]["mass"] == 2.5);
  CHECK(khr["scenes"][0]["nodes"] == nlohmann::json{0});
  REQUIRE(object["children"].size() == 2);
  for (const std::size_t child : object["children"]) {
    const auto& node = khr["nodes"][child];
    CHECK(!node.contains("mesh"));
    const auto& geometry = node["extensions"]["KHR_physics_rigid_bodies"]["collider"]["geometry"];
    CHECK(geometry["convexHull"] == true);
    const std::size_t mesh = khr["nodes"][geometry["node"].get<std::size_t>()]["mesh"];
    const std::size_t indices = khr["meshes"][mesh]["primitives"][0]["indices"];
    CHECK(khr["accessors"][indices]["count"] == 12);
  }
  const std::size_t position = khr["meshes"][2]["primitives"][0]["attributes"]["POSITION"];
  CHECK(khr["accessors"][position]["min"][1] == -1.5);  // the tip of the other one, 3 units below
  CHECK(khr["extensionsUsed"] == nlohmann::json{"KHR_materials_unlit", "KHR_physics_rigid_bodies"});
  for (const auto& [names, name] : {std::pair{io::ColliderNames::kUnreal, "UCX_object_01"},
                                    std::pair{io::ColliderNames::kGodot, "collider01-convcolonly"}}) {
    const nlohmann::json gltf = gltf_of(names);
    const std::size_t second = gltf["nodes"][0]["children"][1];
    CHECK(gltf["nodes"][second]["name"] == name);
    CHECK(gltf["nodes"][second]["mesh"] == 2);
    CHECK(gltf["extensionsUsed"] == nlohmann::json{"KHR_materials_unlit"});
  }
  CHECK(khr["meshes"][0]["name"] == "object");
}

}  // namespace
}  // namespace ngs
