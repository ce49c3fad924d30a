#include <doctest/doctest.h>

#include <cmath>

#include "ngs/io/formats/splat_codecs.h"
#include "ngs/io/formats/write_splat.h"
#include "support/splat_files.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

TEST_CASE("a compressed.ply of two Gaussians has the expected bytes") {
  GaussianCloud cloud = test::plain_cloud(2, 1, 3);
  cloud.position = {0, 0, 0, 2, 4, 8};
  cloud.log_scale = {-1, -1, -1, -1, -1, 1};
  cloud.rotation = {2, 0, 0, 0, 0, 0, -1, 0};
  cloud.logit_opacity = {0, INFINITY};
  cloud.sh_dc = {0, 0, 0, float(0.5 / 0.28209479), 0, 0};
  cloud.sh_rest.assign(18, 0.f);
  cloud.sh_rest[0] = 5.f;
  cloud.sh_rest[1] = -5.f;
  cloud.sh_rest[5] = 0.99f;
  const test::TempDir dir;
  (void)io::write_splat(dir.file("m.compressed.ply"), cloud, {});
  const std::string file = test::read_bytes(dir.file("m.compressed.ply"));
  const std::size_t body = file.find("end_header\n") + 11;
  CHECK(file.substr(0, body).find("element chunk 1\nproperty float min_x\n") != std::string::npos);
  CHECK(file.substr(0, body).find("element vertex 2\nproperty uint packed_position\n") != std::string::npos);
  std::string expected;
  for (const float v : {0.f, 0.f, 0.f, 2.f, 4.f, 8.f, -1.f, -1.f, -1.f, -1.f, -1.f, 1.f, .5f, .5f, .5f, 1.f, .5f, .5f})
    expected += test::little_endian(v);
  for (const std::uint32_t word : {0u, 0u << 30 | 512u << 20 | 512u << 10 | 512u, 0u, 128u, 0xffffffffu,
                                   2u << 30 | 512u << 20 | 512u << 10 | 512u, 2047u, 0xff0000ffu})
    expected += test::little_endian(word);
  // all of red, then green, then blue: 5 and -5 at the ends, 0 in bin 128, 0.99 in bin 128 + 31
  expected += std::string("\xff\x80\x80\x00\x80\x80\x80\x9f\x80", 9) + std::string(9, '\x80');
  CHECK(file.substr(body) == expected);
}

TEST_CASE("a compressed.ply round trip loses at most half a step of every attribute") {
  for (const int degree : {0, 2, 3}) {
    CAPTURE(degree);
    GaussianCloud cloud = test::plain_cloud(700, degree, 17);
    cloud.antialiased = degree == 2;
    const GaussianCloud back = test::written_and_read(cloud, "m.compressed.ply");
    const test::SplatError error = test::splat_error(cloud, test::in_order_of(cloud, back));
    constexpr double kRounding = 1e-6;
    CHECK(error.position <= 6.0 / 1023 / 2 + kRounding);  // y has 10 bits; a chunk is no larger than the model
    CHECK(error.log_scale <= 10.0 / 1023 / 2 + kRounding);
    CHECK(error.opacity <= 0.5 / 255 + kRounding);
    CHECK(error.sh_dc <= 3.4 / 255 / 2 + kRounding);
    CHECK(error.sh_rest <= 8 / 256.0 / 2 + kRounding);
    CHECK(error.rotation <= 3 * std::sqrt(2.0) / 1023 / 2 * 1.01);
  }
}

}  // namespace
}  // namespace ngs
