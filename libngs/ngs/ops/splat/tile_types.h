#pragma once
// Inputs of the compositing kernels of one tile: plain memory only, because there is one kernel per instruction set and
// their translation units must share no code (paper.md §5.1). Templated on the storage scalar S (float in production,
// double and Dual in tests).
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "ngs/ops/splat/splat_step_kernels.h"

namespace ngs {

inline constexpr int kTilePx = 16;
inline constexpr int kTilePixels = kTilePx * kTilePx;
NGS_HD constexpr int tiles_across(int size_px) { return (size_px + kTilePx - 1) / kTilePx; }

/// The scalar for differences of positions and for per-Gaussian sums.
template <class S>
using WideOf = std::conditional_t<std::is_same_v<S, float>, double, S>;

/// A visible Gaussian as the compositing loops read it: 56 bytes for float.
///
// clang-format off
///   mean_x, mean_y           projected mean, px; wide: in float it is off by 3e-5 px at 1000 px, and alpha by as much
///   form                     the conic: alpha = min(0.99, 2^exponent) by splat_exponent
///   log2_opacity             rounded once, so that an opacity of 1/255 reaches the Gaussian's centre
///   max_mahalanobis2         2 ln(255 · opacity): quadratic form above which alpha < 1/255
///   inv_det                  1 / det(blurred covariance) = a c - b²
///   half_width, half_height  px, of the ellipse {quadratic form <= max_mahalanobis2}
///   bottom_x                 px, x of the ellipse's lowest point relative to the mean
///   inv_c                    1 / c of the conic
// clang-format on
template <class S>
struct SplatRecord {
  WideOf<S> mean_x, mean_y;
  PowerForm<S> form;
  S log2_opacity, max_mahalanobis2, inv_det, half_width, half_height, bottom_x, inv_c;
};

/// The pixels of one tile.
struct TileFrame {
  int x_px, y_px;           // first column and row
  int width_px, height_px;  // of the image
  [[gnu::always_inline]] NGS_HD int rows() const { return kTilePx < height_px - y_px ? kTilePx : height_px - y_px; }
  [[gnu::always_inline]] NGS_HD int columns() const { return kTilePx < width_px - x_px ? kTilePx : width_px - x_px; }
  /// Index into the image of a pixel of the tile.
  [[gnu::always_inline]] NGS_HD std::size_t pixel(int x, int y) const {
    return std::size_t(y_px + y) * std::size_t(width_px) + std::size_t(x_px + x);
  }
};

/// The Gaussians of one tile, nearest first: record[visible[e]]; slot[e] numbers the pair (Gaussian, tile).
template <class S>
struct TileWork {
  TileFrame frame;
  const SplatRecord<S>* record;
  const std::uint32_t *visible, *slot;  // [entries]
  std::uint32_t entries;
  S stop;  // a pixel stops before its transmittance would fall below this
};

/// One channel of an image: pixel i at data[i · stride]. Null data: not wanted (output), zero (input).
template <class T>
struct Plane {
  T* data = nullptr;
  int stride = 1;
};

/// Channel values per Gaussian, [V, count], indexed by `visible`.
template <class S>
struct ChannelValues {
  const S* data;
  int count;
  [[gnu::always_inline]] NGS_HD const S* row(std::uint32_t v) const {
    return data + std::size_t(v) * std::size_t(count);
  }
};

template <class S>
struct ForwardTile {
  TileWork<S> work;
  ChannelValues<S> value;
  const S* background;  // [count]
  const Plane<S>* out;  // [count + 1], the last one alpha
  S* scratch;           // [count · kTilePixels]
};

/// A recorded traversal of a tile, so that the backward pass can go back to front without dividing by 1 - alpha: 8
/// bytes per contributing (Gaussian, pixel) pair, at most ~2300 per pixel (each lowers T by 1/255 or more). `lanes`
/// holds alpha and transmittance of each contribution, 2 · kLanes values.
template <class S>
struct Tape {
  struct Span {
    std::uint32_t entry, column;
    std::size_t begin;
  };
  S* lanes = nullptr;           // [lane_capacity]
  std::uint8_t* row = nullptr;  // [lane_capacity / 2]
  std::size_t size = 0;         // contributions
  std::size_t lane_capacity = 0;
  Span* span = nullptr;
  std::size_t spans = 0, span_capacity = 0;
  /// Grows the capacity by at least kTilePx contributions of `lanes` lanes and one span.
  void (*grow)(Tape&, int lanes) = nullptr;
};

/// Geometry columns of the gradient of a (Gaussian, tile) pair: mean, conic, log opacity. Channels follow.
inline constexpr int kPairGeometry = 6;

constexpr std::size_t backward_scratch(int count) {
  return std::size_t((count + 1) * kTilePixels + 2 * count * kTilePx);
}

template <class S>
struct BackwardTile {
  TileWork<S> work;
  ChannelValues<S> value;
  const S* background;         // [count]
  const Plane<const S>* grad;  // [count + 1] ∂L/∂(channel), ∂L/∂alpha
  const std::uint8_t* moves;   // [count] whether channel c's gradient reaches alpha
  S* pair_grad;  // [pairs, kPairGeometry + count]; row slot[e] is overwritten for every entry that contributes
  S* scratch;    // [backward_scratch(count)]
  Tape<S>* tape;
};

constexpr std::size_t evidence_scratch(int objects) {
  return std::size_t((objects + 1) * kTilePixels + 2 * (2 + 2 * objects) * kTilePx);
}

/// Per (Gaussian, tile) pair: [W, n, W1_0, n1_0, W1_1, n1_1, ...]; see ops/splat/evidence.h.
template <class S>
struct EvidenceTile {
  TileWork<S> work;
  const std::uint8_t* known;   // [H·W] or null: all
  const float* const* target;  // [objects][H·W]
  int objects;
  S* pair;                     // [pairs, 2 + 2 · objects]; the row of every entry is overwritten
  S* scratch;                  // [evidence_scratch(objects)]
  bool by_visibility = false;  // weights are α T², not α T
};

/// The kernels of one lane type.
///
///   record   records the traversal of the tile; transmittance [kTilePixels]: the final one, in packs
template <class S>
struct TileKernels {
  int lanes;
  void (*record)(const TileWork<S>&, Tape<S>&, S* transmittance);
  void (*forward)(const ForwardTile<S>&);
  void (*backward)(const BackwardTile<S>&);
  void (*evidence)(const EvidenceTile<S>&);
};

}  // namespace ngs
