#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "ngs/io/formats/splat_codecs.h"
#include "ngs/io/formats/write_splat.h"
#include "support/splat_files.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

struct Glb {
  nlohmann::json json;
  std::string binary;

  explicit Glb(const std::string& file) {
    const auto word = [&](std::size_t at) {
      std::uint32_t v;
      std::memcpy(&v, file.data() + at, sizeof v);
      return v;
    };
    REQUIRE(file.substr(0, 4) == "glTF");
    CHECK(word(4) == 2);
    CHECK(word(8) == file.size());
    CHECK(word(12) % 4 == 0);
    CHECK(file.substr(16, 4) == "JSON");
    json = nlohmann::json::parse(file.substr(20, word(12)));
    const std::size_t next = 20 + word(12);
    if (next == file.size()) return;
    CHECK(file.substr(next + 4, 4) == std::string("BIN\0", 4));
    binary = file.substr(next + 8);
    CHECK(word(next) == binary.size());
  }

  std::vector<float> values(const std::string& attribute) const {
    const nlohmann::json& primitive = json["meshes"][0]["primitives"][0];
    const nlohmann::json& accessor = json["accessors"][primitive["attributes"][attribute].get<std::size_t>()];
    const nlohmann::json& view = json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    CHECK(accessor["componentType"] == 5126);
    std::vector<float> values(view["byteLength"].get<std::size_t>() / sizeof(float));
    std::memcpy(values.data(), binary.data() + view["byteOffset"].get<std::size_t>(), values.size() * sizeof(float));
    return values;
  }
};

TEST_CASE("a .glb has the attributes of KHR_gaussian_splatting, x left, y up, z forward") {
  GaussianCloud cloud = test::plain_cloud(2, 2, 9);
  cloud.position = {1, 2, 3, -4, 5, -6};
  cloud.rotation = {2, 0, 0, 0, 0.5f, 0.5f, -0.5f, 0.5f};
  cloud.log_scale = {0, 1, -1, 2, 3, 4};
  cloud.logit_opacity = {0, INFINITY};
  const test::TempDir dir;
  CHECK(io::write_splat(dir.file("m.glb"), cloud, {}).empty());
  const Glb glb(test::read_bytes(dir.file("m.glb")));
  const nlohmann::json& primitive = glb.json["meshes"][0]["primitives"][0];
  CHECK(glb.json["asset"]["version"] == "2.0");
  CHECK(glb.json["extensionsUsed"] == nlohmann::json::array({"KHR_gaussian_splatting"}));
  CHECK(glb.json["scenes"][0]["nodes"] == nlohmann::json::array({0}));
  CHECK(glb.json["nodes"][0]["mesh"] == 0);
  CHECK(glb.json["buffers"][0]["byteLength"] == glb.binary.size());
  CHECK(primitive["mode"] == 0);
  CHECK(primitive["extensions"]["KHR_gaussian_splatting"]["kernel"] == "ellipse");
  CHECK(glb.json["accessors"][0]["min"] == nlohmann::json::array({-1.0, -5.0, -6.0}));
  CHECK(glb.json["accessors"][0]["max"] == nlohmann::json::array({4.0, -2.0, 3.0}));
  CHECK(glb.json["accessors"][0]["count"] == 2);

  const std::string splat = "KHR_gaussian_splatting:";
  CHECK(glb.values("POSITION") == std::vector<float>{-1, -2, 3, 4, -5, -6});
  CHECK(glb.values(splat + "ROTATION") == std::vector<float>{0, 0, 0, 1, -0.5f, 0.5f, 0.5f, 0.5f});
  CHECK(glb.values(splat + "SCALE")[1] == doctest::Approx(std::exp(1.0)));
  CHECK(glb.values(splat + "OPACITY") == std::vector<float>{0.5f, 1.f});
  CHECK(glb.values(splat + "SH_DEGREE_0_COEF_0") == cloud.sh_dc);
  // y and x change their sign with the axes, z does not; of xy xx-yy and zz none does, of yz and xz both do
  const int sign[8] = {-1, 1, -1, 1, -1, 1, -1, 1};
  for (int k = 0; k < 8; ++k) {
    const int degree = k < 3 ? 1 : 2, n = k < 3 ? k : k - 3;
    const std::vector<float> found =
        glb.values(splat + "SH_DEGREE_" + std::to_string(degree) + "_COEF_" + std::to_string(n));
    REQUIRE(found.size() == 6);
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        CHECK(found[i * 3 + c] == float(sign[k]) * cloud.sh_rest[(i * 8 + std::size_t(k)) * 3 + c]);
  }
}

TEST_CASE("an empty model gives a valid .glb") {
  const test::TempDir dir;
  (void)io::write_splat(dir.file("m.glb"), test::plain_cloud(3, 1, 1), {0, 0, 0});
  CHECK(Glb(test::read_bytes(dir.file("m.glb"))).json["scenes"].size() == 1);
}

}  // namespace
}  // namespace ngs
