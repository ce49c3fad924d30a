#pragma once
// The evidence kernel of one tile: the sums of ops/splat/evidence.h per (Gaussian, tile) pair.
#include "ngs/ops/splat/splat_tiles.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs {

inline constexpr int kAnyObjects = -1;

/// The sums of an entry.
template <class L>
typename LaneTraits<L>::Scalar* row_of(const EvidenceTile<typename LaneTraits<L>::Scalar>& in, std::uint32_t e) {
  return in.pair + std::size_t(in.work.slot[e]) * std::size_t(2 + 2 * in.objects);
}

/// K objects, the first ones, or kAnyObjects: all. Weights are α T; with kByVisibility α T².
template <class L, int K, bool kByVisibility>
struct EvidenceSink {
  using S = typename LaneTraits<L>::Scalar;
  using F = typename LaneTraits<L>::Folded;
  static constexpr int kLanes = LaneTraits<L>::kLanes, kSums = K == kAnyObjects ? 0 : 2 + 2 * K;
  static constexpr bool kTakesEmpty = true;
  static constexpr std::uint32_t kPrefetchPairs = 24;  // prefetch distance of the sums, in pairs
  const EvidenceTile<S>& in;
  const S* mask;  // [packs][1 + objects][lanes]: known, targets
  ChannelSums<L, kSums> sum;
  ChannelSums<F, kSums> total;
  std::uint32_t entry = 0, seen = 0;
  bool reached = false;

  EvidenceSink(const EvidenceTile<S>& tile, const S* masks, S* memory)
      : in(tile), mask(masks), sum(memory), total(memory + sums() * kTilePx) {}
  [[gnu::always_inline]] int objects() const { return K == kAnyObjects ? in.objects : K; }
  [[gnu::always_inline]] int sums() const { return 2 + 2 * objects(); }

  void begin(std::uint32_t e) {
    entry = e;
    seen = e + 1;
    reached = false;
    total.clear(sums());
    if (e + kPrefetchPairs < in.work.entries) __builtin_prefetch(row(e + kPrefetchPairs), 1);
  }
  void begin_column(int) { sum.clear(sums()); }
  [[gnu::always_inline]] void add(std::uint32_t, const Contribution<L>& hit) {
    const S* planes = mask + std::size_t(hit.pack) * std::size_t((1 + objects()) * kLanes);
    L weight = hit.alpha * hit.transmittance;
    if constexpr (kByVisibility) weight = weight * hit.transmittance;
    const L zero(S(0)), one(S(1));
    L known;
    load_lanes(planes, known);
    sum.put(0, fma_lanes(weight, known, sum.get(0)));
    sum.put(1, sum.get(1) + select(hit.alpha > zero, known, zero));
    for (int k = 0; k < objects(); ++k) {
      L m;
      load_lanes(planes + (1 + k) * kLanes, m);
      sum.put(2 + 2 * k, fma_lanes(weight, m, sum.get(2 + 2 * k)));
      sum.put(3 + 2 * k, sum.get(3 + 2 * k) + select((m >= L(S(kHalfShare))) & (hit.alpha > zero), one, zero));
    }
  }
  void end_column(int) {
    for (int i = 0; i < sums(); ++i) total.put(i, total.get(i) + folded(sum.get(i)));
    reached = true;
  }
  void end() {
    if (reached)
      total.sum_each(sums(), row(entry));
    else
      clear(entry);
  }
  /// Zeroes the entries behind the point where the tile stopped.
  void end_tile() const {
    for (std::uint32_t e = seen; e < in.work.entries; ++e) clear(e);
  }
  S* row(std::uint32_t e) const { return row_of<L>(in, e); }
  void clear(std::uint32_t e) const {
    S* at = row(e);
    for (int i = 0; i < sums(); ++i) at[i] = S(0);
  }
};

template <class L, int K, bool kByVisibility = false>
void evidence_tile(const EvidenceTile<typename LaneTraits<L>::Scalar>& in) {
  using S = typename LaneTraits<L>::Scalar;
  constexpr int kLanes = LaneTraits<L>::kLanes;
  const TileFrame frame = in.work.frame;
  const int objects = K == kAnyObjects ? in.objects : K, planes = 1 + objects;
  for (int i = 0; i < planes * kTilePixels; ++i) in.scratch[i] = S(0);  // 0 outside the image and where unknown
  for (int y = 0; y < frame.rows(); ++y)
    for (int x = 0; x < frame.columns(); ++x) {
      const std::size_t pixel = frame.pixel(x, y);
      if (in.known && !in.known[pixel]) continue;
      S* at = in.scratch + (x / kLanes * kTilePx + y) * planes * kLanes + x % kLanes;
      at[0] = S(1);
      for (int k = 0; k < objects; ++k) at[(1 + k) * kLanes] = S(in.target[k][pixel]);
    }
  EvidenceSink<L, K, kByVisibility> sink(in, in.scratch, in.scratch + planes * kTilePixels);
  L transmittance[kPacksPerTile<L>];
  composite_tile<L>(in.work, transmittance, sink);
  sink.end_tile();
}

/// Whether every target is 0, or 1, in all pixels of the tile, as in most tiles: contours are elsewhere.
template <class L>
bool has_uniform_targets(const EvidenceTile<typename LaneTraits<L>::Scalar>& in) {
  const TileFrame& frame = in.work.frame;
  const auto is_all = [&](const auto* plane, auto value) {
    for (int y = 0; y < frame.rows(); ++y)
      for (int x = 0; x < frame.columns(); ++x)
        if (plane[frame.pixel(x, y)] != value) return false;
    return true;
  };
  if (in.known && !is_all(in.known, std::uint8_t(1))) return false;
  for (int k = 0; k < in.objects; ++k)
    if (const float value = in.target[k][frame.pixel(0, 0)]; (value != 0 && value != 1) || !is_all(in.target[k], value))
      return false;
  return true;
}

/// evidence_tile() for uniform targets: the sums of an object are 0, or those of the Gaussian.
template <class L, bool kByVisibility>
void evidence_of_uniform(const EvidenceTile<typename LaneTraits<L>::Scalar>& in) {
  using S = typename LaneTraits<L>::Scalar;
  evidence_tile<L, 0, kByVisibility>(in);
  const std::size_t first = in.work.frame.pixel(0, 0);
  for (std::uint32_t e = 0; e < in.work.entries; ++e) {
    S* at = row_of<L>(in, e);
    for (int k = 0; k < in.objects; ++k)
      for (int i = 0; i < 2; ++i) at[2 + 2 * k + i] = in.target[k][first] == 1 ? at[i] : S(0);
  }
}

}  // namespace ngs
