#pragma once
// Encodings that the compressed formats share.
#include <array>
#include <cmath>
#include <cstdint>

#include "ngs/core/error.h"
#include "ngs/math/sh.h"
#include "ngs/math/stable.h"

namespace ngs::io {

/// `value` rounded to the nearest byte; beyond 0 and 255 the nearer end.
inline std::uint8_t to_byte(double value) { return std::uint8_t(std::lround(clamp3(value, 0.0, 255.0))); }

/// Opacity in 255ths. 0 and 255 stand for logits of -Inf and +Inf, which are legal.
inline std::uint8_t alpha_byte(float logit_opacity) { return to_byte(255 * sigmoid(double(logit_opacity))); }
inline float logit_of_alpha_byte(std::uint8_t alpha) { return float(logit(double(alpha) / 255)); }

/// The component of a unit quaternion that the "smallest three" encodings leave out; at equal size the first.
inline std::size_t largest_component(const std::array<float, 4>& q) {
  std::size_t largest = 0;
  for (std::size_t k = 1; k < 4; ++k)
    if (std::abs(q[k]) > std::abs(q[largest])) largest = k;
  return largest;
}

/// The component left out, of the other three.
inline double left_out_component(double a, double b, double c) {
  return std::sqrt(clamp3(1 - (a * a + b * b + c * c), 0.0, 1.0));
}

/// Refuses a file whose data would be more than kMostExpansion times its own size: what deflate can do at most, and far
/// beyond what any model with positions of its own compresses to. So a small file cannot ask for much memory.
inline constexpr std::uint64_t kMostExpansion = 1032;
inline void check_expansion(const std::string& name, std::uint64_t decoded_bytes, std::uint64_t file_bytes) {
  if (decoded_bytes / kMostExpansion <= file_bytes) return;
  throw Error(ErrorCode::kBadInput,
              name + ": " + std::to_string(file_bytes) + " bytes that announce " + std::to_string(decoded_bytes) +
                  " bytes of data, expected at most " + std::to_string(kMostExpansion) + " times as many",
              "the file is damaged or hostile: copy or export it again");
}

}  // namespace ngs::io
