#pragma once
// Layout of .spz (Niantic; specification and reference: github.com/nianticlabs/spz).
//
// clang-format off
//   header           u32 magic "NGSP", u32 version, u32 count, u8 SH degree, u8 fractional bits of positions, u8 flags,
//                    u8 number of streams (version 4, else 0)
//   versions 1 to 3  header and attributes, one after the other, in one gzip stream
//   version 4        header; u32 offset of the stream table, 12 bytes reserved, extensions up to the table; the table,
//                    two u64 (compressed size, size) per stream; then one zstd stream per attribute
// clang-format on
//
// Attributes, each for all Gaussians: positions (3 half floats in version 1, else 3 fixed-point numbers of 24 bits),
// opacity (byte), colours (3 bytes), log scales (3 bytes), rotation (x y z as bytes in versions 1 and 2, else the
// smallest three of x y z w in 2 + 3 · 10 bits), SH (bytes, the three channels of a coefficient together).
#include <array>
#include <cstddef>
#include <cstdint>

namespace ngs::io::spz {

inline constexpr std::uint32_t kMagic = 0x5053474e;
inline constexpr std::size_t kHeaderBytes = 16, kHeaderBytesV4 = 32, kTableEntryBytes = 16;
inline constexpr std::uint8_t kAntialiased = 1, kHasExtensions = 2;
inline constexpr std::uint32_t kLastVersion = 4, kMaxDegree = 4;

inline constexpr std::size_t kAttributes = 6;
enum Attribute : std::size_t { kPosition, kAlpha, kColour, kScale, kRotation, kSh };

/// Bytes of each attribute of one Gaussian.
constexpr std::array<std::size_t, kAttributes> attribute_bytes(std::uint32_t version, std::uint32_t degree) {
  const std::size_t sh = 3 * ((degree + 1) * (degree + 1) - 1);
  return {version == 1 ? std::size_t(6) : std::size_t(9), 1, 3, 3, version < 3 ? std::size_t(3) : std::size_t(4), sh};
}

// value = (byte - offset) / steps
inline constexpr double kColourOffset = 127.5, kColourSteps = 255 * 0.15;
inline constexpr double kScaleOffset = 160, kScaleSteps = 16;  // ln scale from -10 to 5.94
inline constexpr double kShOffset = 128, kShSteps = 128;
inline constexpr double kQuaternionOffset = 127.5, kQuaternionSteps = 127.5;  // versions 1 and 2

inline constexpr std::uint32_t kMagnitudeBits = 9, kMaxMagnitude = (1u << kMagnitudeBits) - 1;  // encodes √½
inline constexpr double kLargestOfSmallest = 0.70710678118654752;

}  // namespace ngs::io::spz
