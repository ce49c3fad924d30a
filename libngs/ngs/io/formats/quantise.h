#pragma once
// Encodings shared by the compressed formats.
#include <array>
#include <cmath>
#include <cstdint>

#include "ngs/core/error.h"
#include "ngs/math/sh.h"
#include "ngs/math/stable.h"

namespace ngs::io {

/// `value` rounded to the nearest integer and clamped to 0..255.
inline std::uint8_t to_byte(double value) { return std::uint8_t(std::lround(clamp3(value, 0.0, 255.0))); }

/// Opacity in 255ths. 0 and 255 decode to logits of -Inf and +Inf, which are valid.
inline std::uint8_t alpha_byte(float logit_opacity) { return to_byte(255 * sigmoid(double(logit_opacity))); }
inline float logit_of_alpha_byte(std::uint8_t alpha) { return float(logit(double(alpha) / 255)); }

/// Index of the largest component of a unit quaternion, which "smallest three" encodings omit; the first of equal ones.
inline std::size_t largest_component(const std::array<float, 4>& q) {
  std::size_t largest = 0;
  for (std::size_t k = 1; k < 4; ++k)
    if (std::abs(q[k]) > std::abs(q[largest])) largest = k;
  return largest;
}

/// The omitted component, from the other three.
inline double left_out_component(double a, double b, double c) {
  return std::sqrt(clamp3(1 - (a * a + b * b + c * c), 0.0, 1.0));
}

/// Rejects a file whose header declares more than kMaxExpansion times the file size: the limit of deflate, and far
/// beyond the compression of any real model. A small file thus cannot allocate much memory.
inline constexpr std::uint64_t kMaxExpansion = 1032;
inline void check_expansion(const std::string& name, std::uint64_t decoded_bytes, std::uint64_t file_bytes) {
  if (decoded_bytes / kMaxExpansion <= file_bytes) return;
  throw Error(ErrorCode::kBadInput,
              name + ": " + std::to_string(file_bytes) + " bytes whose header declares " +
                  std::to_string(decoded_bytes) + " bytes of data, expected at most " + std::to_string(kMaxExpansion) +
                  " times as many",
              "the file is damaged or hostile: copy or export it again");
}

// IEEE 754 half-precision numbers.
inline float half_to_float(std::uint16_t half) {
  const int exponent = (half >> 10) & 31, mantissa = half & 1023;
  const float sign = (half & 0x8000) != 0 ? -1.f : 1.f;
  if (exponent == 31) return mantissa != 0 ? NAN : sign * INFINITY;
  return sign * (exponent == 0 ? std::ldexp(float(mantissa), -24) : std::ldexp(float(1024 + mantissa), exponent - 25));
}

}  // namespace ngs::io
