#pragma once
// Small masks for contour tests: random masks, and shapes that are difficult for distance transforms.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "ngs/core/rng.h"
#include "ngs/ops/image/metrics.h"

namespace ngs::test {

struct Mask {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> data;
  Mask() = default;
  Mask(int width, int height) : width_px(width), height_px(height), data(std::size_t(width) * std::size_t(height), 0) {}
  std::uint8_t& at(int x, int y) { return data[std::size_t(y) * std::size_t(width_px) + std::size_t(x)]; }
  std::uint8_t at(int x, int y) const { return data[std::size_t(y) * std::size_t(width_px) + std::size_t(x)]; }
  MaskPlane plane() const { return {data.data(), width_px, height_px}; }
};

enum class MaskKind : int {
  kEmpty,
  kFull,
  kOnePixel,
  kOneHole,
  kChecker,
  kStripes,
  kFrame,
  kDiagonal,
  kComb,
  kRings,
  kHalf,
  kNoise,
  kSparseNoise,
  kDenseNoise,
  kBlobs,
  kCount
};

inline bool shape_contains(MaskKind kind, int x, int y, const Mask& mask, std::uint64_t seed) {
  const int w = mask.width_px, h = mask.height_px;
  const std::uint64_t index = std::uint64_t(y) * std::uint64_t(w) + std::uint64_t(x);
  const auto random = [&](std::uint64_t i) { return rng_uniform(seed, RngStream::kTest, i); };
  const int spot_x = int(random(1u << 20) * w), spot_y = int(random((1u << 20) + 1) * h);
  const int period = 2 + int(random((1u << 20) + 2) * 7);
  switch (kind) {
    case MaskKind::kEmpty: return false;
    case MaskKind::kFull: return true;
    case MaskKind::kOnePixel: return x == spot_x && y == spot_y;
    case MaskKind::kOneHole: return !(x == spot_x && y == spot_y);
    case MaskKind::kChecker: return ((x / (period / 2) + y / (period / 2)) & 1) != 0;
    case MaskKind::kStripes: return x % period != 0;
    case MaskKind::kFrame: return x == 0 || y == 0 || x == w - 1 || y == h - 1;
    case MaskKind::kDiagonal: return (x + y) % period == 0;
    case MaskKind::kComb: return y < h / 3 || x % period < 2;
    case MaskKind::kRings: return std::max(std::abs(x - spot_x), std::abs(y - spot_y)) / period % 2 == 0;
    case MaskKind::kHalf: return x < spot_x;
    case MaskKind::kNoise: return random(index) < 0.5;
    case MaskKind::kSparseNoise: return random(index) < 0.02;
    case MaskKind::kDenseNoise: return random(index) < 0.98;
    default: {
      for (std::uint64_t blob = 0; blob < 4; ++blob) {
        const double cx = random((1u << 21) + 3 * blob) * w, cy = random((1u << 21) + 3 * blob + 1) * h;
        const double r = 1 + random((1u << 21) + 3 * blob + 2) * std::max(w, h) / 3;
        if ((x + 0.5 - cx) * (x + 0.5 - cx) + (y + 0.5 - cy) * (y + 0.5 - cy) < r * r) return true;
      }
      return false;
    }
  }
}

inline Mask zoo_mask(MaskKind kind, int width_px, int height_px, std::uint64_t seed) {
  Mask mask(width_px, height_px);
  for (int y = 0; y < height_px; ++y)
    for (int x = 0; x < width_px; ++x) mask.at(x, y) = shape_contains(kind, x, y, mask, seed) ? 255 : 0;
  return mask;
}

/// One erosion by a 3x3 square; pixels outside the image are background (zero padding).
inline Mask eroded(const Mask& mask) {
  Mask out(mask.width_px, mask.height_px);
  for (int y = 0; y < mask.height_px; ++y)
    for (int x = 0; x < mask.width_px; ++x) {
      bool keep = x > 0 && y > 0 && x + 1 < mask.width_px && y + 1 < mask.height_px;
      for (int dy = -1; keep && dy <= 1; ++dy)
        for (int dx = -1; keep && dx <= 1; ++dx) keep = mask.at(x + dx, y + dy) != 0;
      out.at(x, y) = keep ? 255 : 0;
    }
  return out;
}

/// The definition: mask minus mask eroded d times.
inline Mask boundary_band(const Mask& mask, int d) {
  Mask core = mask;
  for (int i = 0; i < d; ++i) core = eroded(core);
  Mask band(mask.width_px, mask.height_px);
  for (std::size_t i = 0; i < band.data.size(); ++i) band.data[i] = mask.data[i] != 0 && core.data[i] == 0 ? 255 : 0;
  return band;
}

}  // namespace ngs::test
