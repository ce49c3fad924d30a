#pragma once
// What the compositing kernels of one tile are given: plain memory only, because one kernel exists per instruction set
// and the translation units of these may share no code (PAPER.md §5.1). Templated on the storage scalar S (float in
// production, double and Dual in tests).
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "ngs/ops/splat/splat_step_kernels.h"

namespace ngs {

inline constexpr int kTilePx = 16;
inline constexpr int kTilePixels = kTilePx * kTilePx;

/// The scalar in which positions are subtracted and per-Gaussian sums are kept.
template <class S>
using WideOf = std::conditional_t<std::is_same_v<S, float>, double, S>;

/// A visible Gaussian as the loops read it: 56 bytes for float.
///   mean_x, mean_y           px; wide, because a float mean at 1000 px is off by 3e-5 px, and alpha by as much
///   form, log2_opacity       alpha = min(0.99, 2^exponent) by splat_exponent; log2_opacity rounded once, so that an
///   opacity
///                            of 1/255 reaches its centre
///   max_mahalanobis2                  2 ln(255 · opacity): the quadratic form above which alpha < 1/255
///   inv_det                  1 / det(blurred covariance) = a c - b²
///   half_width, half_height  px, of the ellipse {quadratic form <= max_mahalanobis2}
///   bottom_x                 px, where the ellipse's lowest point lies, from the mean
///   inv_c                    1 / c of the conic
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
};

/// The Gaussians of one tile, nearest first: record[visible[e]], and the slot of the pair (Gaussian, tile).
template <class S>
struct TileWork {
  TileFrame frame;
  const SplatRecord<S>* record;
  const std::uint32_t *visible, *slot;  // [entries]
  std::uint32_t entries;
  S stop;  // a pixel ends before its transmittance falls below this
};

/// Where one channel of an image lives: pixel i at data[i · stride]. Null data: not wanted / zero.
template <class T>
struct Plane {
  T* data = nullptr;
  int stride = 1;
};

/// Values composited per Gaussian, [V, count] by `visible`.
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

/// The traversal of a tile as it was recorded, so that the backward pass can go from the far end without dividing by
/// 1 - alpha: 8 bytes per contributing (Gaussian, pixel) pair, at most ~2300 per pixel (T falls by 1/255 each).
/// `lanes` holds alpha and transmittance of each contribution, 2 · kLanes values.
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
  /// Makes room for kTilePx more contributions of `lanes` lanes and one more span.
  void (*grow)(Tape&, int lanes) = nullptr;
};

/// Gradient of one (Gaussian, tile) pair before it is summed per Gaussian: mean, conic, log opacity, then channels.
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
///   record   traverses the tile into the tape; transmittance [kTilePixels]: the final one, in packs
template <class S>
struct TileKernels {
  int lanes;
  void (*record)(const TileWork<S>&, Tape<S>&, S* transmittance);
  void (*forward)(const ForwardTile<S>&);
  void (*backward)(const BackwardTile<S>&);
  void (*evidence)(const EvidenceTile<S>&);
};

}  // namespace ngs
