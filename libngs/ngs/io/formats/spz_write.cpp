#include <algorithm>
#include <cstring>

#include "ngs/core/error.h"
#include "ngs/io/formats/axes.h"
#include "ngs/io/formats/compression/gzip.h"
#include "ngs/io/formats/quantise.h"
#include "ngs/io/formats/splat_codecs.h"
#include "ngs/io/formats/spz_layout.h"
#include "ngs/scene/precision/local_origin.h"

namespace ngs::io {
namespace {

using namespace spz;

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
