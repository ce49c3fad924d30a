#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "ngs/core/error.h"
#include "ngs/io/formats/axes.h"
#include "ngs/io/formats/splat_codecs.h"
#include "ngs/io/formats/write_splat.h"
#include "ngs/math/quat.h"
#include "ngs/math/sh.h"
#include "support/ply_text.h"
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

/// A .glb with this JSON, padded, and the binary chunk of `file`.
std::string with_json(const std::string& file, std::string json) {
  const auto word = [&](std::size_t at) {
    std::uint32_t v;
    std::memcpy(&v, file.data() + at, sizeof v);
    return v;
  };
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto length = std::uint32_t(json.size());
  return file.substr(0, 12) + std::string(reinterpret_cast<const char*>(&length), 4) + "JSON" + json +
         file.substr(20 + word(12));
}

std::string json_of(const std::string& file) {
  std::uint32_t length;
  std::memcpy(&length, file.data() + 12, sizeof length);
  return file.substr(20, length);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

/// The colour without its constant band that a row shows in direction d, red only.
double shown(const io::PlyTable& rows, std::int64_t i, Vec3<double> d) {
  double basis[15], sum = 0;
  sh_rest_basis(3, d, basis);
  for (int k = 0; k < 15; ++k) sum += basis[k] * rows.column("f_rest_" + std::to_string(k)).value(i);
  return sum;
}

TEST_CASE("a .glb is read as it was written, at every SH degree") {
  for (const int degree : {0, 1, 3}) {
    const GaussianCloud cloud = test::plain_cloud(20, degree, 5), back = test::written_and_read(cloud, "m.glb");
    CHECK(back.position == cloud.position);
    CHECK(back.sh_dc == cloud.sh_dc);
    CHECK(back.sh_rest == cloud.sh_rest);
    for (std::size_t i = 0; i < cloud.log_scale.size(); ++i)
      CHECK(back.log_scale[i] == doctest::Approx(cloud.log_scale[i]).epsilon(1e-6));
    for (std::size_t i = 0; i < 20; ++i)
      CHECK(back.logit_opacity[i] == doctest::Approx(cloud.logit_opacity[i]).epsilon(1e-5));
  }
}

TEST_CASE("the node's transform moves, turns and scales positions, ellipsoids and colours") {
  const test::TempDir dir;
  (void)io::write_splat(dir.file("m.glb"), test::plain_cloud(2, 3, 5), {});
  const std::string plain = test::read_bytes(dir.file("m.glb"));
  const std::string turned = with_json(
      plain, replaced(json_of(plain), R"({"mesh":0})",
                      R"({"children":[1],"scale":[2,2,2]},{"mesh":0,"rotation":[0,0.6,0,0.8],"translation":[1,0,0]})"));
  const io::PlyTable before = io::decode_glb("a.glb", test::as_bytes(plain)).rows;
  const io::PlyTable after = io::decode_glb("b.glb", test::as_bytes(turned)).rows;
  // glTF's frame is the PLY's turned by 180 degrees about z, so a rotation about y reverses.
  const Mat3<double> r = rotation_matrix(Vec4<double>{0.8, 0, -0.6, 0});
  for (std::int64_t i = 0; i < 2; ++i) {
    const auto at = [i](const io::PlyTable& rows) {
      return Vec3<double>{rows.column("x").value(i), rows.column("y").value(i), rows.column("z").value(i)};
    };
    const Vec3<double> expected = 2.0 * (r * at(before)) + Vec3<double>{-2, 0, 0}, off = at(after) - expected;
    CHECK(std::sqrt(dot(off, off)) < 1e-5);
    CHECK(after.column("scale_1").value(i) == doctest::Approx(before.column("scale_1").value(i) + std::log(2.0)));
    const auto axes = [i](const io::PlyTable& rows) {
      float q[4];
      for (int k = 0; k < 4; ++k) q[k] = rows.column("rot_" + std::to_string(k)).value_float(i);
      return axes_of_quaternion(q);
    };
    const Mat3<double> wanted = r * axes(before), found = axes(after);
    for (int k = 0; k < 9; ++k) CHECK(found.m[k] == doctest::Approx(wanted.m[k]).epsilon(1e-5));
    for (const Vec3<double> d : {Vec3<double>{1, 0, 0}, Vec3<double>{0.6, 0, 0.8}, Vec3<double>{0.48, 0.6, 0.64}})
      CHECK(shown(after, i, r * d) == doctest::Approx(shown(before, i, d)).epsilon(1e-5));
  }
}

TEST_CASE("the rotation to -y turns every axis upright") {
  for (const char* axis : {"x", "-x", "y", "-y", "z", "-z"}) {
    const Vec3<double> up = io::rotation_to_minus_y(io::axis_named(axis)) * io::axis_named(axis);
    CHECK(up.y == doctest::Approx(-1));
  }
}

TEST_CASE("a .glb without splats, with compressed ones, or with an uneven node is rejected") {
  const test::TempDir dir;
  (void)io::write_splat(dir.file("m.glb"), test::plain_cloud(2, 1, 5), {});
  const std::string file = test::read_bytes(dir.file("m.glb")), json = json_of(file);
  const auto refused = [&](const std::string& from, const std::string& to, const char* message) {
    const std::string changed = with_json(file, replaced(json, from, to));
    CHECK_THROWS_WITH_AS(io::decode_glb("m.glb", test::as_bytes(changed)), doctest::Contains(message), Error);
  };
  refused(R"("extensions":{"KHR)", R"("extensions":{"OTHER)", "no Gaussian splats");
  refused(R"("kernel":)", R"("extensions":{"KHR_gaussian_splatting_compression_spz_2":{}},"kernel":)", "compressed");
  refused(R"({"mesh":0})", R"({"mesh":0,"scale":[1,2,1]})", "differs from a rotation");
  refused(R"({"mesh":0})", R"({"mesh":0,"scale":[-1,1,1]})", "without a reflection");
  refused(R"({"mesh":0})", R"({"mesh":0,"children":[0]})", "expected a tree");
  refused(R"("count":2)", R"("count":3)", "has another count");
  refused(R"("count":2)", R"("count":200)", "ends after the file");
  refused(R"("POSITION":0)", R"("POSITION":99)", "accessors[99]: missing");
}

}  // namespace
}  // namespace ngs
