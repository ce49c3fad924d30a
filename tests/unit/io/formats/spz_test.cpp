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

std::string header(std::uint32_t version, std::uint32_t count, int degree, int bits, int flags = 0, int streams = 0) {
  return "NGSP" + little_endian(version) + little_endian(count) + char(degree) + char(bits) + char(flags) +
         char(streams);
}

const std::string kAlpha = "\x80", kColour = std::string("\0\x80\xff", 3), kScale = std::string("\x00\xa0\xff", 3);
// (1, -2, 3 1/2) with 8 fractional bits, in the file's frame
const std::string kPosition = std::string("\x00\x01\x00\x00\xfe\xff\x80\x03\x00", 9);
// the largest is w; x = 511/511, y = -256/511, z = 0, in units of √½
const std::string kRotation = little_endian(std::uint32_t(3u << 30 | 511u << 20 | (512u + 256u) << 10 | 0u));
const std::string kSh1 = std::string("\x80\xff\x00\xc0\x40\x81\x7f\x90\x70", 9);

/// Common to all versions: x right, y down, z forward.
void check_common(const GaussianCloud& cloud) {
  REQUIRE(cloud.size() == 1);
  CHECK(cloud.logit_opacity[0] == doctest::Approx(std::log(128.0 / 127)).epsilon(1e-6));
  CHECK(cloud.sh_dc[0] == doctest::Approx(-0.5 / 0.15));
  CHECK(cloud.sh_dc[1] == doctest::Approx((128 / 255.0 - 0.5) / 0.15));
  CHECK(cloud.sh_dc[2] == doctest::Approx(0.5 / 0.15));
  CHECK(cloud.log_scale == std::vector<float>{-10.f, 0.f, 5.9375f});
  CHECK(cloud.position[0] == 1.f);
  CHECK(cloud.position[1] == 2.f);
  CHECK(cloud.position[2] == -3.5f);
}

io::GaussianPly read_bytes(const std::string& bytes) {
  const test::TempDir dir;
  dir.write("model.spz", bytes);
  return io::read_gaussian_ply(dir.file("model.spz"));
}

io::DecodedSplat decode(const std::string& bytes) { return io::decode_spz("model.spz", test::as_bytes(bytes)); }

std::string version_4(const std::string& head, const std::string& extensions,
                      const std::vector<std::string>& attributes) {
  std::string table, streams;
  for (const std::string& attribute : attributes) {
    const std::string stream = test::raw_zstd(attribute);
    table += little_endian(std::uint64_t(stream.size())) + little_endian(std::uint64_t(attribute.size()));
    streams += stream;
  }
  return head + little_endian(std::uint32_t(32 + extensions.size())) + std::string(12, '\0') + extensions + table +
         streams;
}

void check_refused(const std::string& bytes, const std::string& part) {
  INFO(part);
  const Error e = test::refused([&] { decode(bytes); }, ErrorCode::kBadInput, part);
  CHECK_FALSE(e.remedy().empty());
}

TEST_CASE("a version 3 .spz written by hand is decoded according to its layout") {
  const io::GaussianPly model =
      read_bytes(test::stored_gzip(header(3, 1, 1, 8, 1) + kPosition + kAlpha + kColour + kScale + kRotation + kSh1));
  check_common(model.cloud);
  CHECK(model.cloud.antialiased);
  const double x = std::sqrt(0.5), y = -256 / 511.0 * std::sqrt(0.5);
  CHECK(model.cloud.rotation[0] == doctest::Approx(std::sqrt(1 - x * x - y * y)));
  CHECK(model.cloud.rotation[1] == doctest::Approx(x));
  CHECK(model.cloud.rotation[2] == doctest::Approx(-y));
  CHECK(model.cloud.rotation[3] == 0.f);
  // y and z of degree 1 change their sign, x does not
  const std::vector<float> expected = {0.f, -127 / 128.f, 1.f, -0.5f, 0.5f, -1 / 128.f, -1 / 128.f, 0.125f, -0.125f};
  CHECK(model.cloud.sh_rest == expected);
}

TEST_CASE("versions 1 and 2 have half floats and three bytes of rotation") {
  const std::string quaternion = std::string("\xff\x80\x40", 3);
  const std::string half = std::string("\x00\x3c\x00\xc0\x00\x43", 6);  // 1, -2, 3.5
  for (const std::uint32_t version : {1u, 2u}) {
    CAPTURE(version);
    const io::GaussianPly model = read_bytes(test::stored_gzip(
        header(version, 1, 0, 8) + (version == 1 ? half : kPosition) + kAlpha + kColour + kScale + quaternion));
    check_common(model.cloud);
    CHECK_FALSE(model.cloud.antialiased);
    CHECK(model.cloud.rotation[1] == 1.f);
    CHECK(model.cloud.rotation[2] == doctest::Approx(-(128 / 127.5 - 1)));
    CHECK(model.cloud.rotation[3] == doctest::Approx(-(64 / 127.5 - 1)));
    CHECK(model.cloud.rotation[0] == 0.f);  // the other three already have a length above 1
  }
}

TEST_CASE("version 4 has a zstd stream per attribute, and may name its frame") {
  const std::vector<std::string> attributes = {kPosition, kAlpha, kColour, kScale, kRotation};
  check_common(read_bytes(version_4(header(4, 1, 0, 8, 0, 5), "", attributes)).cloud);
  const std::string unknown = little_endian(0x12340001u) + little_endian(3u) + "abc";
  const auto in_frame = [&](std::uint32_t system) {
    const std::string named = little_endian(0xADBE0003u) + little_endian(4u) + little_endian(system);
    return read_bytes(version_4(header(4, 1, 0, 8, 2, 5), unknown + named, attributes)).cloud;
  };
  check_common(in_frame(4));
  CHECK(in_frame(6).position == std::vector<float>{1.f, -2.f, 3.5f});    // right down front: a PLY's
  CHECK(in_frame(1).position == std::vector<float>{-1.f, -2.f, -3.5f});  // left down back
  check_refused(version_4(header(4, 1, 0, 8, 2, 5), little_endian(0xADBE0003u) + little_endian(4u) + little_endian(9u),
                          attributes),
                "coordinate system 9");
}

TEST_CASE("SH of degree 4 are truncated to 3, with a note") {
  std::string sh(72, '\x80');
  sh[44] = '\xff';
  sh[45] = '\x00';
  const io::GaussianPly model =
      read_bytes(test::stored_gzip(header(3, 1, 4, 8) + kPosition + kAlpha + kColour + kScale + kRotation + sh));
  CHECK(model.cloud.sh_degree == 3);
  CHECK(model.cloud.sh_rest[44] == 127 / 128.f);
  CHECK(model.notes.back().find("degree 4") != std::string::npos);
}

TEST_CASE("an .spz round trip loses at most half a step of every attribute") {
  for (const int degree : {0, 1, 2, 3}) {
    CAPTURE(degree);
    GaussianCloud cloud = test::plain_cloud(700, degree, 11);
    cloud.antialiased = degree == 2;
    const test::SplatError error = test::splat_error(cloud, test::written_and_read(cloud, "m.spz"));
    constexpr double kRounding = 1e-6;  // of float, in values up to 9
    CHECK(error.position <= std::ldexp(0.5, -16) + kRounding);
    CHECK(error.log_scale <= 1 / 32.0 + kRounding);
    CHECK(error.opacity <= 0.5 / 255 + kRounding);
    CHECK(error.sh_dc <= 0.5 / 255 / 0.15 + kRounding);
    CHECK(error.sh_rest <= 0.5 / 128 + kRounding);
    // The three that are stored lose h = √½ / 511 / 2. The fourth is L = √(1 - Σ q²) >= 1/2: h Σ|q| / L <= 3 h, and
    // a term quadratic in h.
    CHECK(error.rotation <= 3 * std::sqrt(0.5) / 1022 * 1.01);
  }
}

TEST_CASE("positions get as many fractional bits as the largest coordinate allows") {
  const auto error_at = [](float reach) {
    GaussianCloud cloud = test::plain_cloud(50, 0, 3);
    for (float& p : cloud.position) p *= reach / 3;
    if (reach < 1)
      for (float& s : cloud.log_scale) s += std::log(reach / 3);
    cloud.position[0] = -reach;
    const test::TempDir dir;
    (void)io::write_splat(dir.file("m.spz"), cloud, {});
    return test::splat_error(cloud, io::read_gaussian_ply(dir.file("m.spz")).cloud).position;
  };
  CHECK(error_at(1e-3f) <= std::ldexp(0.5, -20) * 1.01);  // finer than 2^-16, which is coarse for this size
  CHECK(error_at(127.f) <= std::ldexp(0.5, -16) * 1.01);
  CHECK(error_at(2000.f) <= std::ldexp(0.5, -12) * 1.01);
  CHECK(error_at(8e6f) <= 0.51);
  CHECK_THROWS_AS(error_at(9e6f), Error);
}

TEST_CASE("equal models give equal .spz bytes, and rows that .spz cannot store are left out and counted") {
  GaussianCloud cloud = test::plain_cloud(20, 1, 5);
  cloud.position[3] = NAN;
  classify(cloud);
  const test::TempDir dir;
  std::vector<std::uint8_t> keep(20, 1);
  keep[0] = 0;
  for (const char* name : {"a.spz", "b.spz"}) {
    const std::vector<std::string> notes = io::write_splat(dir.file(name), cloud, keep);
    REQUIRE(notes.size() == 1);
    CHECK(notes[0].find("1 Gaussians") != std::string::npos);
  }
  CHECK(test::read_bytes(dir.file("a.spz")) == test::read_bytes(dir.file("b.spz")));
  const io::GaussianPly back = io::read_gaussian_ply(dir.file("a.spz"));
  REQUIRE(back.cloud.size() == 18);
  CHECK(back.cloud.position[0] == doctest::Approx(cloud.position[6]).epsilon(1e-4));
}

TEST_CASE("values outside the ranges of .spz are clamped") {
  GaussianCloud cloud = test::plain_cloud(1, 1, 5);
  cloud.log_scale = {-30.f, 20.f, 0.f};
  cloud.logit_opacity[0] = INFINITY;
  cloud.sh_dc[0] = 9.f;
  cloud.sh_rest[0] = -7.f;
  const test::TempDir dir;
  (void)io::write_splat(dir.file("m.spz"), cloud, {});
  const GaussianCloud back = io::read_gaussian_ply(dir.file("m.spz")).cloud;
  CHECK(back.log_scale == std::vector<float>{-10.f, 5.9375f, 0.f});
  CHECK(back.logit_opacity[0] == INFINITY);
  CHECK(back.sh_dc[0] == doctest::Approx(0.5 / 0.15));
  CHECK(back.sh_rest[0] == doctest::Approx(-127 / 128.0));  // mirrored, it is clamped at the opposite end
}

TEST_CASE("an .spz truncated at any byte is rejected") {
  const std::string gzip =
      test::stored_gzip(header(3, 1, 1, 8) + kPosition + kAlpha + kColour + kScale + kRotation + kSh1);
  const std::string zstd =
      version_4(header(4, 1, 1, 8, 0, 6), "", {kPosition, kAlpha, kColour, kScale, kRotation, kSh1});
  CHECK_NOTHROW(decode(gzip));
  CHECK_NOTHROW(decode(zstd));
  for (std::size_t n = 0; n < gzip.size(); ++n) CHECK_THROWS_AS(decode(gzip.substr(0, n)), Error);
  for (std::size_t n = 0; n < zstd.size(); ++n) CHECK_THROWS_AS(decode(zstd.substr(0, n)), Error);
}

TEST_CASE("an .spz with invalid counts is rejected before memory is allocated") {
  const std::string payload = kPosition + kAlpha + kColour + kScale + kRotation;
  check_refused(test::stored_gzip(header(3, 0xffffffffu, 3, 8) + payload), "expected at most 1032 times as many");
  check_refused(test::stored_gzip(header(3, 2, 0, 8) + payload), "bytes early");
  check_refused(test::stored_gzip(header(5, 1, 0, 8) + payload), "version 5");
  check_refused(test::stored_gzip(header(4, 1, 0, 8) + payload), "version 4 of .spz in a gzip stream");
  check_refused(test::stored_gzip(header(3, 1, 5, 8) + payload), "SH degree 5");
  check_refused(test::stored_gzip(header(3, 1, 0, 60) + payload), "60 fractional bits");
  check_refused(test::stored_gzip("PK\x03\x04 something else"), "NGSP");
  std::string damaged = test::stored_gzip(header(3, 1, 0, 8) + payload);
  damaged[damaged.size() - 8] ^= 1;
  check_refused(damaged, "damaged gzip stream");
  const std::vector<std::string> attributes = {kPosition, kAlpha, kColour, kScale, kRotation};
  check_refused(version_4(header(4, 0xffffffffu, 0, 8, 0, 5), "", attributes), "expected at most 1032 times as many");
  check_refused(version_4(header(4, 1, 0, 8, 0, 7), "", attributes), "7 streams, expected 5");
  check_refused(version_4(header(3, 1, 0, 8, 0, 5), "", attributes), "version 3 of .spz without gzip");
  check_refused(version_4(header(4, 1, 0, 8, 0, 5), "", {kPosition, kAlpha, kColour, kScale, kRotation + "x"}),
                "stream 4 of 5 bytes, expected 4");
  std::string longer = version_4(header(4, 1, 0, 8, 0, 5), "", attributes);
  longer[32] = '\x7f';  // the first stream extends over the others' bytes
  check_refused(longer, "stream 0");
}

}  // namespace
TEST_CASE("a distant row that makes the steps wider than the Gaussians is reported") {
  GaussianCloud cloud = test::plain_cloud(600, 1, 21);
  for (float& s : cloud.log_scale) s = -4;
  const test::TempDir dir;
  for (const char* name : {"m.spz", "m.compressed.ply"}) {
    CAPTURE(name);
    GaussianCloud spread = cloud;
    CHECK(io::write_splat(dir.file(name), spread, {}).empty());
    spread.position[3 * 77] = 5e6f;
    const std::vector<std::string> notes = io::write_splat(dir.file(name), spread, {});
    REQUIRE(notes.size() == 1);
    CHECK(notes[0].find("row 77 of the model lies at 5000000") != std::string::npos);
    if (std::string(name) == "m.spz")
      CHECK(notes[0].find("600 of 600 positions are rounded to steps of 1,") != std::string::npos);
  }
  for (const char* name : {"m.ply", "m.sog", "m.splat"}) CHECK(io::write_splat(dir.file(name), cloud, {}).empty());
}

}  // namespace ngs
