#include <doctest/doctest.h>

#include <cmath>

#include "ngs/core/error.h"
#include "ngs/io/formats/splat_codecs.h"
#include "ngs/io/formats/write_splat.h"
#include "support/error_code.h"
#include "support/ply_text.h"
#include "support/splat_files.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

using test::little_endian;

std::string record(float x, float y, float z, float scale, const std::string& rgba, const std::string& rotation) {
  return little_endian(x) + little_endian(y) + little_endian(z) + little_endian(scale) + little_endian(scale * 2) +
         little_endian(scale * 4) + rgba + rotation;
}

TEST_CASE("a .splat written by hand is decoded according to its layout") {
  const test::TempDir dir;
  dir.write("m.splat", record(1, -2, 3, 0.5f, std::string("\x00\x80\xff\x33", 4), std::string("\x00\x80\x80\x80", 4)) +
                           record(4, 5, 6, 1, std::string("\xff\xff\xff\x00", 4), std::string("\x80\xc0\x40\x80", 4)));
  const io::GaussianPly model = io::read_gaussian_ply(dir.file("m.splat"));
  REQUIRE(model.cloud.size() == 2);
  CHECK(model.cloud.sh_degree == 0);
  CHECK(model.cloud.position == std::vector<float>{1, -2, 3, 4, 5, 6});
  CHECK(model.cloud.log_scale[0] == doctest::Approx(std::log(0.5)));
  CHECK(model.cloud.log_scale[2] == doctest::Approx(std::log(2.0)));
  CHECK(model.cloud.sh_dc[0] == doctest::Approx(-0.5 / 0.28209479));
  CHECK(model.cloud.sh_dc[2] == doctest::Approx(0.5 / 0.28209479));
  CHECK(model.cloud.logit_opacity[0] == doctest::Approx(std::log(0.2 / 0.8)));
  CHECK(model.cloud.logit_opacity[1] == -INFINITY);
  CHECK(std::vector<float>(model.cloud.rotation.begin(), model.cloud.rotation.begin() + 4) ==
        std::vector<float>{-1, 0, 0, 0});
  CHECK(model.cloud.rotation[5] == doctest::Approx(std::sqrt(0.5)));
  CHECK(model.cloud.rotation[6] == doctest::Approx(-std::sqrt(0.5)));
}

TEST_CASE("a .splat round trip loses only quantisation and higher SH") {
  GaussianCloud cloud = test::plain_cloud(700, 2, 7);
  const test::TempDir dir;
  CHECK(io::write_splat(dir.file("m.splat"), cloud, {}).empty());
  CHECK(test::read_bytes(dir.file("m.splat")).size() == 700 * 32);
  const io::GaussianPly back = io::read_gaussian_ply(dir.file("m.splat"));
  REQUIRE(back.cloud.sh_degree == 0);
  cloud.sh_rest.clear();
  const test::SplatError error = test::splat_error(cloud, back.cloud);
  CHECK(error.position == 0);
  CHECK(error.log_scale <= 2e-6);  // exp and log in float
  CHECK(error.opacity <= 0.5 / 255 + 1e-6);
  CHECK(error.sh_dc <= 0.5 / 255 / 0.28209479 + 1e-6);
  // Half a step in each of four components is at most 2 · 1/256 in length; the length is divided out again.
  CHECK(error.rotation <= 2 / 256.0);
}

TEST_CASE("the identity rotation survives a .splat round trip exactly") {
  GaussianCloud cloud = test::plain_cloud(1, 0, 7);
  cloud.rotation = {5, 0, 0, 0};
  const test::TempDir dir;
  (void)io::write_splat(dir.file("m.splat"), cloud, {});
  CHECK(test::splat_error(cloud, io::read_gaussian_ply(dir.file("m.splat")).cloud).rotation == 0);
}

TEST_CASE("NaN scales and positions of a .splat exclude their rows") {
  const std::string fine = std::string("\x80\x80\x80\x80", 4), turned = std::string("\xff\x80\x80\x80", 4);
  const std::string bytes = record(1, 2, 3, 1, fine, turned) + record(NAN, 2, 3, 1, fine, turned) +
                            record(1, 2, 3, -1, fine, turned) + record(1, 2, 3, 0, fine, turned);
  const test::TempDir dir;
  dir.write("m.splat", bytes);
  const io::GaussianPly model = io::read_gaussian_ply(dir.file("m.splat"));
  CHECK(model.cloud.usable == std::vector<std::uint8_t>{1, 0, 0, 0});
  CHECK(model.health.excluded() == 3);
}

TEST_CASE("a .splat with an incomplete record is rejected") {
  const std::string bytes(64, '\0');
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    if (n == 32) continue;
    CAPTURE(n);
    const Error e =
        test::thrown_by([&] { (void)io::decode_dot_splat("cut.splat", test::as_bytes(bytes.substr(0, n))); });
    CHECK(e.code() == ErrorCode::kBadInput);
    CHECK(std::string(e.what()).find("expected records of 32 bytes") != std::string::npos);
  }
}

}  // namespace
}  // namespace ngs
