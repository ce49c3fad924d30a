#include <doctest/doctest.h>

#include <cmath>

#include "ngs/core/error.h"
#include "ngs/io/formats/splat_codecs.h"
#include "ngs/io/formats/write_splat.h"
#include "ngs/io/ply/gaussian_ply.h"
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

namespace {

using test::little_endian;

void put(std::string& bytes, std::size_t at, const std::string& value) { bytes.replace(at, value.size(), value); }

/// One section of `rows` Gaussians, of two buckets where compressed: one full with 1, one with the rest.
struct File {
  std::string header = std::string(4096, '\0'), section = std::string(1024, '\0'), body;

  File(int compression, std::uint32_t rows, int degree) {
    put(header, 1, "\x01");
    put(header, 4, little_endian(1u));
    put(header, 16, little_endian(rows));
    put(header, 20, little_endian(std::uint16_t(compression)));
    put(header, 36, little_endian(-2.f));
    put(header, 40, little_endian(2.f));
    put(section, 0, little_endian(rows));
    put(section, 4, little_endian(rows));
    put(section, 40, little_endian(std::uint16_t(degree)));
    if (compression == 0) return;
    put(section, 8, little_endian(1u));
    put(section, 12, little_endian(2u));
    put(section, 16, little_endian(4.f));
    put(section, 20, little_endian(std::uint16_t(12)));
    put(section, 24, little_endian(32767u));
    put(section, 32, little_endian(1u));
    put(section, 36, little_endian(1u));
    body = little_endian(rows - 1);
    for (const float centre : {10.f, 20.f, 30.f, -10.f, -20.f, -30.f}) body += little_endian(centre);
  }
  std::string bytes() const { return header + section + body; }
};

std::string floats(const std::vector<float>& values) {
  std::string bytes;
  for (const float v : values) bytes += little_endian(v);
  return bytes;
}
std::string words(const std::vector<int>& values) {
  std::string bytes;
  for (const int v : values) bytes += little_endian(std::uint16_t(v));
  return bytes;
}

const std::string kColour = std::string("\x00\xff\x80\x33", 4);

GaussianCloud read_bytes(const std::string& bytes) {
  const test::TempDir dir;
  return io::read_gaussian_ply(dir.write("m.ksplat", bytes)).cloud;
}

TEST_CASE("a .ksplat without compression holds floats, SH band by band and channel by channel") {
  File file(0, 1, 2);
  std::vector<float> sh;
  for (int k = 0; k < 24; ++k) sh.push_back(float(k));
  file.body = floats({1, -2, 3, 1, std::exp(1.f), 2, 0.5f, 0.5f, -0.5f, 0.5f}) + kColour + floats(sh);
  const GaussianCloud cloud = read_bytes(file.bytes());
  REQUIRE(cloud.size() == 1);
  CHECK(cloud.position == std::vector<float>{1, -2, 3});
  CHECK(cloud.log_scale[1] == doctest::Approx(1));
  CHECK(cloud.rotation == std::vector<float>{0.5f, 0.5f, -0.5f, 0.5f});
  CHECK(cloud.sh_dc[0] == doctest::Approx(-0.5 / 0.28209479));
  CHECK(cloud.logit_opacity[0] == doctest::Approx(std::log(0.25)));
  // coefficient k of the first band is at k, 3 + k, 6 + k; of the second, five a channel, from 9 on
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t c = 0; c < 3; ++c) CHECK(cloud.sh_rest[k * 3 + c] == float(c * 3 + k));
  for (std::size_t k = 0; k < 5; ++k)
    for (std::size_t c = 0; c < 3; ++c) CHECK(cloud.sh_rest[(3 + k) * 3 + c] == float(9 + c * 5 + k));
}

TEST_CASE("a compressed .ksplat has positions about the centres of its buckets") {
  for (const int compression : {1, 2}) {
    CAPTURE(compression);
    File file(compression, 3, 1);
    for (int i = 0; i < 3; ++i) {
      file.body += words({32767, 65534, 0}) + words({0x3c00, 0x4000, 0x3800}) + words({0x3c00, 0, 0, 0}) + kColour;
      if (compression == 1) file.body += words({0x3c00, 0, 0, 0xbc00, 0, 0, 0, 0, 0x4000});
      if (compression == 2) file.body += std::string("\xff\x80\x80\x00\x80\x80\x80\x80\xff", 9);
    }
    const GaussianCloud cloud = read_bytes(file.bytes());
    REQUIRE(cloud.size() == 3);
    CHECK(cloud.position == std::vector<float>{10, 22, 28, -10, -18, -32, -10, -18, -32});
    CHECK(cloud.log_scale[0] == 0.f);
    CHECK(cloud.log_scale[1] == doctest::Approx(std::log(2.0)));
    CHECK(cloud.rotation[0] == 1.f);
    CHECK(cloud.sh_rest[0] == doctest::Approx(compression == 1 ? 1.0 : 2.0));
    CHECK(cloud.sh_rest[1] == doctest::Approx(compression == 1 ? -1.0 : -2.0));
    CHECK(cloud.sh_rest[8] == doctest::Approx(2.0));
  }
}

void check_refused(const std::string& bytes, const std::string& part) {
  INFO(part);
  test::refused([&] { (void)io::decode_ksplat("m.ksplat", test::as_bytes(bytes)); }, ErrorCode::kBadInput, part);
}

TEST_CASE("a truncated .ksplat, or one with invalid counts, is rejected before memory is allocated") {
  File good(1, 2, 0);
  for (int i = 0; i < 2; ++i) good.body += words({1, 2, 3, 4, 5, 6, 7, 8, 9, 10}) + kColour;
  CHECK(read_bytes(good.bytes()).size() == 2);
  for (std::size_t n = 0; n < good.bytes().size(); n += n < 5120 ? 97 : 1)
    check_refused(good.bytes().substr(0, n), "xpected");
  const auto with = [&](bool in_section, std::size_t at, const std::string& value) {
    File file = good;
    put(in_section ? file.section : file.header, at, value);
    return file.bytes();
  };
  check_refused(with(false, 0, "\x01"), "version 1.1");
  check_refused(with(false, 4, little_endian(0xffffffffu)), "4294967295 sections");
  check_refused(with(false, 16, little_endian(3u)), "2 Gaussians in its sections, expected 3");
  check_refused(with(false, 20, little_endian(std::uint16_t(3))), "compression 3");
  check_refused(with(true, 0, little_endian(3u)), "3 Gaussians in a section, expected at most 2");
  check_refused(with(true, 4, little_endian(0xffffffffu)), "expected a complete file");
  check_refused(with(true, 12, little_endian(0xffffffffu)), "expected a complete file");
  check_refused(with(true, 20, little_endian(std::uint16_t(0))), "without the centres");
  check_refused(with(true, 40, little_endian(std::uint16_t(4))), "SH degree 4");
  File few = good;
  put(few.body, 0, little_endian(0u));
  check_refused(few.bytes(), "less capacity than it has Gaussians");
}

}  // namespace
}  // namespace ngs
