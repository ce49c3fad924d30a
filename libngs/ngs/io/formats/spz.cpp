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
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "ngs/core/error.h"
#include "ngs/io/files/byte_reader.h"
#include "ngs/io/formats/compression/gzip.h"
#include "ngs/io/formats/quantise.h"
#include "ngs/io/formats/splat_codecs.h"
#include "ngs/io/formats/splat_table.h"
#include "ngs/scene/precision/local_origin.h"

namespace ngs::io {
namespace {

constexpr std::uint32_t kMagic = 0x5053474e;
constexpr std::size_t kHeaderBytes = 16, kHeaderBytesV4 = 32, kTableEntryBytes = 16;
constexpr std::uint8_t kAntialiased = 1, kHasExtensions = 2;
constexpr std::uint32_t kLastVersion = 4, kMaxDegree = 4;

constexpr std::size_t kAttributes = 6;
enum Attribute : std::size_t { kPosition, kAlpha, kColour, kScale, kRotation, kSh };

/// Bytes of each attribute of one Gaussian.
constexpr std::array<std::size_t, kAttributes> attribute_bytes(std::uint32_t version, std::uint32_t degree) {
  const std::size_t sh = 3 * ((degree + 1) * (degree + 1) - 1);
  return {version == 1 ? std::size_t(6) : std::size_t(9), 1, 3, 3, version < 3 ? std::size_t(3) : std::size_t(4), sh};
}

// value = (byte - offset) / steps
constexpr double kColourOffset = 127.5, kColourSteps = 255 * 0.15;
constexpr double kScaleOffset = 160, kScaleSteps = 16;  // ln scale from -10 to 5.94
constexpr double kShOffset = 128, kShSteps = 128;
constexpr double kQuaternionOffset = 127.5, kQuaternionSteps = 127.5;  // versions 1 and 2

constexpr std::uint32_t kMagnitudeBits = 9, kMaxMagnitude = (1u << kMagnitudeBits) - 1;  // encodes √½
constexpr double kLargestOfSmallest = 0.70710678118654752;

struct Header {
  std::uint32_t magic, version, count;
  std::uint8_t degree, fractional_bits, flags, streams;
};
static_assert(sizeof(Header) == kHeaderBytes);

struct SpzData {
  Header header{};
  AxisSigns axes = kRightUpBack;
  std::array<std::vector<std::uint8_t>, kAttributes> attributes;
};

[[noreturn]] void bad(const std::string& name, const std::string& message) {
  throw Error(ErrorCode::kBadInput, name + ": " + message, "copy or export it again");
}

void check_header(const std::string& name, const Header& header, std::size_t file_bytes) {
  if (header.magic != kMagic)
    throw Error(ErrorCode::kBadInput, name + ": compressed data without the signature NGSP, expected an .spz file",
                "if it is another file, compressed, unpack it (gunzip); else copy it again");
  if (header.version < 1 || header.version > kLastVersion)
    bad(name, "version " + std::to_string(header.version) + " of .spz, expected 1 to 4");
  if (header.degree > kMaxDegree) bad(name, "SH degree " + std::to_string(header.degree) + ", expected 0 to 4");
  if (header.fractional_bits > 24)
    bad(name, std::to_string(header.fractional_bits) + " fractional bits of positions, expected at most 24");
  std::uint64_t row_bytes = 0;
  for (const std::size_t bytes : attribute_bytes(header.version, header.degree)) row_bytes += bytes;
  check_expansion(name, header.count * row_bytes, file_bytes);
}

SpzData read_gzip(const std::string& name, Bytes bytes) {
  SpzData data;
  GunzipReader reader(name, bytes);
  std::array<std::uint8_t, kHeaderBytes> head;
  reader.read(head);
  data.header = std::bit_cast<Header>(head);
  check_header(name, data.header, bytes.size());
  if (data.header.version == kLastVersion)
    bad(name, "version 4 of .spz in a gzip stream, expected it to begin with NGSP");
  const auto sizes = attribute_bytes(data.header.version, data.header.degree);
  for (std::size_t a = 0; a < kAttributes; ++a) {
    data.attributes[a].resize(data.header.count * sizes[a]);
    reader.read(data.attributes[a]);
  }
  reader.finish();
  return data;
}

/// The frame named by extension 0xADBE0003: 1 to 8 for the combinations of left/right, down/up and back/front.
AxisSigns named_axes(const std::string& name, Bytes zone) {
  constexpr std::uint32_t kCoordinateSystem = 0xADBE0003;
  ByteReader reader(zone, name + ": extensions");
  AxisSigns axes = kRightUpBack;
  while (reader.left() > 0) {
    const auto type = reader.read<std::uint32_t>();
    const auto size = reader.read<std::uint32_t>();
    if (type != kCoordinateSystem || size != 4) {
      reader.skip(size);
      continue;
    }
    const auto system = reader.read<std::uint32_t>();
    if (system > 8)
      bad(name, "coordinate system " + std::to_string(system) +
                    ", expected 1 to 8 (x left or right, y down or up, z "
                    "back or front)");
    if (system == 0) continue;
    const std::uint32_t choice = system - 1;
    axes = {(choice & 1) != 0 ? 1.f : -1.f, (choice & 2) != 0 ? -1.f : 1.f, (choice & 4) != 0 ? 1.f : -1.f};
  }
  return axes;
}

SpzData read_zstd(const std::string& name, Bytes bytes) {
  SpzData data;
  ByteReader reader(bytes, name);
  data.header = reader.read<Header>();
  check_header(name, data.header, bytes.size());
  if (data.header.version != kLastVersion)
    bad(name, "version " + std::to_string(data.header.version) + " of .spz without gzip, expected version 4");
  const auto table_at = reader.read<std::uint32_t>();
  const std::size_t streams = data.header.degree == 0 ? kAttributes - 1 : kAttributes;
  if (data.header.streams != streams)
    bad(name, std::to_string(data.header.streams) + " streams, expected " + std::to_string(streams));
  if (table_at < kHeaderBytesV4 || table_at > bytes.size())
    bad(name, "table of streams at byte " + std::to_string(table_at) + ", expected it within the file");
  if ((data.header.flags & kHasExtensions) != 0)
    data.axes = named_axes(name, bytes.subspan(kHeaderBytesV4, table_at - kHeaderBytesV4));
  ByteReader table(bytes.subspan(table_at), name);
  std::size_t at = table_at + streams * kTableEntryBytes;
  const auto sizes = attribute_bytes(kLastVersion, data.header.degree);
  for (std::size_t a = 0; a < streams; ++a) {
    const auto packed = table.read<std::uint64_t>(), size = table.read<std::uint64_t>();
    if (size != data.header.count * sizes[a])
      bad(name, "stream " + std::to_string(a) + " of " + std::to_string(size) + " bytes, expected " +
                    std::to_string(data.header.count * sizes[a]) + " for " + std::to_string(data.header.count) +
                    " Gaussians");
    if (at > bytes.size() || packed > bytes.size() - at)
      bad(name, "stream " + std::to_string(a) + " goes beyond the end of the file, expected a complete file");
    data.attributes[a].resize(size);
    unzstd(name + ": stream " + std::to_string(a), bytes.subspan(at, packed), data.attributes[a]);
    at += packed;
  }
  return data;
}

class Decoder {
 public:
  explicit Decoder(const SpzData& data)
      : data_(data), bytes_(attribute_bytes(data.header.version, data.header.degree)) {}

  SplatRow row(std::size_t i) const {
    SplatRow row;
    for (std::size_t a = 0; a < 3; ++a) {
      row.position[a] = position(i, a);
      row.sh_dc[a] = float((at(kColour, i)[a] - kColourOffset) / kColourSteps);
      row.log_scale[a] = float((at(kScale, i)[a] - kScaleOffset) / kScaleSteps);
    }
    row.logit_opacity = logit_of_alpha_byte(*at(kAlpha, i));
    const std::size_t coefficients = std::min<std::size_t>(bytes_[kSh], row.sh_rest.size());
    for (std::size_t k = 0; k < coefficients; ++k) row.sh_rest[k] = float((at(kSh, i)[k] - kShOffset) / kShSteps);
    row.rotation = data_.header.version < 3 ? three_bytes(at(kRotation, i)) : smallest_three(at(kRotation, i));
    reverse_axes(row, data_.axes);
    return row;
  }

 private:
  const std::uint8_t* at(Attribute a, std::size_t i) const { return data_.attributes[a].data() + i * bytes_[a]; }

  float position(std::size_t i, std::size_t axis) const {
    if (data_.header.version == 1) {
      std::uint16_t half;
      std::memcpy(&half, at(kPosition, i) + axis * 2, sizeof half);
      return half_to_float(half);
    }
    const std::uint8_t* b = at(kPosition, i) + axis * 3;
    const std::int32_t fixed =
        std::int32_t(std::uint32_t(b[0]) << 8 | std::uint32_t(b[1]) << 16 | std::uint32_t(b[2]) << 24) /
        256;  // keeps the sign
    return float(std::ldexp(double(fixed), -int(data_.header.fractional_bits)));
  }

  static std::array<float, 4> three_bytes(const std::uint8_t* b) {
    double v[3];
    for (std::size_t k = 0; k < 3; ++k) v[k] = (b[k] - kQuaternionOffset) / kQuaternionSteps;
    return {float(left_out_component(v[0], v[1], v[2])), float(v[0]), float(v[1]), float(v[2])};
  }

  /// The two highest bits are the index of the largest of (x, y, z, w); the others follow in order, sign and magnitude.
  static std::array<float, 4> smallest_three(const std::uint8_t* from) {
    std::uint32_t bits;
    std::memcpy(&bits, from, sizeof bits);
    const std::size_t largest = bits >> 30;
    double v[4] = {0, 0, 0, 0};
    for (std::size_t k = 4; k-- > 0;) {
      if (k == largest) continue;
      v[k] = kLargestOfSmallest * double(bits & kMaxMagnitude) / double(kMaxMagnitude);
      if ((bits >> kMagnitudeBits & 1) != 0) v[k] = -v[k];
      bits >>= kMagnitudeBits + 1;
    }
    v[largest] = std::sqrt(clamp3(1 - (v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3]), 0.0, 1.0));
    return {float(v[3]), float(v[0]), float(v[1]), float(v[2])};
  }

  const SpzData& data_;
  std::array<std::size_t, kAttributes> bytes_;
};

constexpr std::uint32_t kWrittenVersion = 3;  // supported by every reader
constexpr int kUsualFractionalBits = 16, kMaxFractionalBits = 24;

struct Farthest {
  double coordinate = 0;
  std::int64_t row = 0;
};

Farthest farthest_of(const SplatSelection& model) {
  Farthest farthest;
  for (const std::int64_t i : model.rows)
    for (const float p : load_row(model, i).position)
      if (std::abs(double(p)) > farthest.coordinate) farthest = {std::abs(double(p)), i};
  return farthest;
}

/// At most 16, as in other writers; more if a step of 2^-16 is coarse for the model's Gaussians, as in millimetre
/// worlds.
int fractional_bits(double farthest, double usual) {
  constexpr double kMaxFixed = 0x7fffff, kFinest = 1.0 / 16;  // of the usual size: invisible in images
  const auto fits = [&](int bits) { return std::nearbyint(std::ldexp(farthest, bits)) <= kMaxFixed; };
  int bits = kUsualFractionalBits;
  while (bits < kMaxFractionalBits && fits(bits + 1) && std::ldexp(1, -bits) > kFinest * usual) ++bits;
  for (; bits >= 0; --bits)
    if (fits(bits)) return bits;
  throw Error(ErrorCode::kUsage, "a coordinate of " + std::to_string(farthest) + ", .spz holds up to 8388607",
              "write the model as PLY, or centre it first");
}

std::uint32_t smallest_three(const std::array<float, 4>& rotation) {
  const std::array<float, 4> q = {rotation[1], rotation[2], rotation[3], rotation[0]};  // x y z w
  const std::size_t largest = largest_component(q);
  std::uint32_t bits = std::uint32_t(largest);
  for (std::size_t k = 0; k < 4; ++k) {
    if (k == largest) continue;
    const bool negative = (q[k] < 0) != (q[largest] < 0);
    const double magnitude = std::abs(double(q[k])) / kLargestOfSmallest * double(kMaxMagnitude);
    bits = bits << (kMagnitudeBits + 1) | std::uint32_t(negative) << kMagnitudeBits |
           std::min(std::uint32_t(std::lround(magnitude)), kMaxMagnitude);
  }
  return bits;
}

class Encoder {
 public:
  Encoder(const SplatSelection& model, int bits) : bits_(bits) {
    const auto degree = std::uint8_t(model.cloud.sh_degree);
    const auto sizes = attribute_bytes(kWrittenVersion, degree);
    std::size_t total = kHeaderBytes;
    for (std::size_t a = 0; a < kAttributes; ++a) {
      size_[a] = sizes[a];
      begin_[a] = total;
      total += sizes[a] * model.rows.size();
    }
    bytes_.resize(total);
    const std::uint32_t head[3] = {kMagic, kWrittenVersion, std::uint32_t(model.rows.size())};
    std::memcpy(bytes_.data(), head, sizeof head);
    bytes_[12] = degree;
    bytes_[13] = std::uint8_t(bits);
    bytes_[14] = model.cloud.antialiased ? kAntialiased : std::uint8_t(0);
  }

  void store(std::size_t i, const SplatRow& row) {
    for (std::size_t a = 0; a < 3; ++a) {
      const auto fixed = std::uint32_t(std::int32_t(std::lround(std::ldexp(double(row.position[a]), bits_))));
      std::uint8_t* position = at(kPosition, i) + a * 3;
      for (int byte = 0; byte < 3; ++byte) position[byte] = std::uint8_t(fixed >> (8 * byte));
      at(kColour, i)[a] = to_byte(row.sh_dc[a] * kColourSteps + kColourOffset);
      at(kScale, i)[a] = to_byte(row.log_scale[a] * kScaleSteps + kScaleOffset);
    }
    *at(kAlpha, i) = alpha_byte(row.logit_opacity);
    const std::uint32_t rotation = smallest_three(row.rotation);
    std::memcpy(at(kRotation, i), &rotation, sizeof rotation);
    for (std::size_t k = 0; k < size_[kSh]; ++k) at(kSh, i)[k] = to_byte(row.sh_rest[k] * kShSteps + kShOffset);
  }

  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  std::uint8_t* at(Attribute a, std::size_t i) { return bytes_.data() + begin_[a] + i * size_[a]; }

  int bits_;
  std::array<std::size_t, kAttributes> size_{}, begin_{};
  std::vector<std::uint8_t> bytes_;
};

}  // namespace

DecodedSplat decode_spz(const std::string& name, Bytes bytes) {
  const bool is_gzip = bytes.size() >= 2 && bytes[0] == 0x1f && bytes[1] == 0x8b;
  const SpzData data = is_gzip ? read_gzip(name, bytes) : read_zstd(name, bytes);
  DecodedSplat decoded;
  decoded.rows = splat_table(data.header.count, std::min<int>(data.header.degree, 3));
  decoded.antialiased = (data.header.flags & kAntialiased) != 0;
  const Decoder decoder(data);
  for (std::int64_t i = 0; i < decoded.rows.rows; ++i) store_row(decoded.rows, i, decoder.row(std::size_t(i)));
  decoded.notes.push_back(".spz: attributes are quantised");
  if (data.header.degree > 3) decoded.notes.push_back(".spz: SH of degree 4 are left out, 0 to 3 are read");
  return decoded;
}

std::vector<std::uint8_t> encode_spz(const SplatSelection& model) {
  Encoder encoder(model, fractional_bits(farthest_of(model).coordinate, usual_size(model.cloud)));
  for (std::size_t i = 0; i < model.rows.size(); ++i) {
    SplatRow row = load_row(model, model.rows[i]);
    reverse_axes(row, kRightUpBack);
    encoder.store(i, row);
  }
  return gzip(encoder.bytes());
}

Rounding spz_rounding(const SplatSelection& model) {
  const Farthest farthest = farthest_of(model);
  const double usual = usual_size(model.cloud);
  const double step = std::ldexp(1, -fractional_bits(farthest.coordinate, usual));
  if (0.5 * step <= usual) return {};
  return {std::ssize(model.rows), step, farthest.row, farthest.coordinate};
}

}  // namespace ngs::io
