#pragma once
// Compressed streams written by hand, and models for the splat format tests.
#include <doctest/doctest.h>

#include <cstdint>
#include <string>

#include "ngs/io/formats/write_splat.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "support/random.h"
#include "support/temp_dir.h"

namespace ngs::test {

template <class T>
std::string little_endian(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

inline std::uint32_t crc32(const std::string& bytes) {
  std::uint32_t crc = ~0u;
  for (const char c : bytes) {
    crc ^= std::uint8_t(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0xedb88320u : 0u);
  }
  return ~crc;
}

/// RFC 1952 with one stored block of RFC 1951: at most 65535 bytes.
inline std::string stored_gzip(const std::string& bytes) {
  const auto size = std::uint16_t(bytes.size());
  return std::string("\x1f\x8b\x08\0\0\0\0\0\0\xff\x01", 11) + little_endian(size) +
         little_endian(std::uint16_t(~size)) + bytes + little_endian(crc32(bytes)) +
         little_endian(std::uint32_t(bytes.size()));
}

/// RFC 8878 with one raw block: at most 255 bytes.
inline std::string raw_zstd(const std::string& bytes) {
  const std::uint32_t block = std::uint32_t(bytes.size()) << 3 | 1;
  return std::string("\x28\xb5\x2f\xfd\x20", 5) + char(bytes.size()) + little_endian(block).substr(0, 3) + bytes;
}

/// Values that every format can store up to quantisation: within ±3, opacities and colours not near their limits.
inline GaussianCloud plain_cloud(std::int64_t n, int degree, std::uint64_t seed) {
  Random random(seed);
  GaussianCloud cloud;
  cloud.resize(n, degree);
  const auto fill = [&](std::vector<float>& values, double low, double high) {
    for (float& v : values) v = float(random.uniform(low, high));
  };
  fill(cloud.position, -3, 3);
  fill(cloud.rotation, -1, 1);
  fill(cloud.log_scale, -9, 1);
  fill(cloud.logit_opacity, -4, 4);
  fill(cloud.sh_dc, -1.7, 1.7);
  fill(cloud.sh_rest, -0.9, 0.9);
  return cloud;
}

/// `cloud` with its rows reordered to match the nearest positions of `reference`.
GaussianCloud in_order_of(const GaussianCloud& reference, const GaussianCloud& cloud);

/// The largest difference of each attribute over the rows of `a` and `b`: position and colours absolute, opacity as a
/// probability, unit quaternions up to their sign.
struct SplatError {
  double position = 0, sh_dc = 0, sh_rest = 0, opacity = 0, log_scale = 0, rotation = 0;
};
SplatError splat_error(const GaussianCloud& a, const GaussianCloud& b);

/// The model as it is read from a file of this name to which it was written.
inline GaussianCloud written_and_read(const GaussianCloud& cloud, const std::string& name) {
  const TempDir dir;
  CHECK(io::write_splat(dir.file(name), cloud, {}).empty());
  GaussianCloud back = io::read_gaussian_ply(dir.file(name)).cloud;
  REQUIRE(back.size() == cloud.size());
  CHECK(back.sh_degree == cloud.sh_degree);
  CHECK(back.antialiased == cloud.antialiased);
  return back;
}

}  // namespace ngs::test
