#include "ngs/ops/labels/label_packs.h"
#include "ngs/ops/labels/label_system.h"

namespace ngs {
namespace {

using namespace label;

constexpr std::size_t kAhead = 64;  // prefetch distance, in contributions

/// Both factors of the pixels of a pack, q and c, then a / q and b / c.
struct WeightedFactors {
  L q, c;
  void start(const PixelPack& p) {
    q = p.foreground;
    c = p.background;
  }
  void add(L weight, L m, L rest) {
    q = fma_lanes(weight, m, q);
    c = fma_lanes(weight, rest, c);
  }
  void divide(const PixelPack& p, LossSum& loss) {
    const L fore = squeezed(q), back = squeezed(c);
    loss.add_weighted(p, fore, back);
    q = p.inside / fore;
    c = p.outside / back;
  }
};

/// Binary targets: only the factor that a pixel's target takes, in q until it is divided.
struct BinaryFactors {
  L q, c, inside;
  void start(const PixelPack& p) {
    inside = p.inside;
    q = select(p.inside > L(0.f), p.foreground, p.background);
  }
  void add(L weight, L m, L rest) { q = fma_lanes(weight, select(inside > L(0.f), m, rest), q); }
  void divide(const PixelPack& p, LossSum& loss) {
    const L factor = squeezed(q);
    loss.add_binary(p, factor);
    const L inverse = L(1.f) / factor;
    q = p.inside * inverse;
    c = p.outside * inverse;
  }
};

/// The labels of the entries of a block, and their sums per band. One per thread; its memory grows and is reused.
struct EntrySums {
  std::vector<float> m, rest;      // [entries]
  std::vector<L> inside, outside;  // [entries, bands]

  void open(const std::vector<LabelBlock::Entry>& entry, ColumnValues at) {
    m.resize(entry.size());
    rest.resize(entry.size());
    for (std::size_t e = 0; e < entry.size(); ++e) {
      m[e] = at.m[entry[e].column];
      rest[e] = at.rest[entry[e].column];
    }
    inside.assign(kBands * entry.size(), L(0.f));
    outside.assign(kBands * entry.size(), L(0.f));
  }
  SlotSums value(std::size_t e) const {
    const std::size_t at = kBands * e;
    return {sum_lanes(inside[at] + inside[at + 1]), sum_lanes(outside[at] + outside[at + 1])};
  }
};

template <class Factors, class Weight>
double evaluate_with(const LabelBlock& block, const Weight* weight, ColumnValues at, SlotSums* slots) {
  static thread_local EntrySums sums;
  sums.open(block.entry, at);
  const float *m = sums.m.data(), *rest = sums.rest.data();
  LossSum loss;
  std::size_t begin = 0;
  for (std::size_t k = 0; k < block.pixel.size(); ++k) {
    const std::size_t end = block.end[k];
    Factors f;
    f.start(block.pixel[k]);
    for_each_place(block, begin, end, [&](std::size_t place, std::size_t i) {
      __builtin_prefetch(weight + i + kAhead);
      f.add(wide(weight[i]), L(m[place / kBands]), L(rest[place / kBands]));
    });
    f.divide(block.pixel[k], loss);
    const auto accumulate = [&](L* sum, L factor) {
      if (!any(factor > L(0.f))) return;  // most packs lie on one side of the mask
      for_each_place(block, begin, end, [&](std::size_t place, std::size_t i) {
        sum[place] = fma_lanes(wide(weight[i]), factor, sum[place]);
      });
    };
    accumulate(sums.inside.data(), f.q);
    accumulate(sums.outside.data(), f.c);
    begin = end;
  }
  for (std::size_t e = 0; e < block.entry.size(); ++e) slots[block.entry[e].slot] = sums.value(e);
  return loss.value();
}

template <class Weight>
double evaluate_block(const LabelBlock& block, const Weight* weight, ColumnValues at, SlotSums* slots) {
  return block.binary ? evaluate_with<BinaryFactors>(block, weight, at, slots)
                      : evaluate_with<WeightedFactors>(block, weight, at, slots);
}

}  // namespace

double evaluate_block(const LabelBlock& block, ColumnValues at, SlotSums* slots) {
  return block.half.empty() ? evaluate_block(block, block.weight.data(), at, slots)
                            : evaluate_block(block, block.half.data(), at, slots);
}

namespace {

/// Replaces the alpha of a contribution by its weight, and returns the weight.
L weight_in_place(float* lane, int lanes) {
  L alpha, before;
  load_lanes(lane, alpha);
  load_lanes(lane + lanes, before);
  const L weight = alpha * before;
  store_lanes(lane, weight);
  return weight;
}

template <class Factors>
struct FactorSink {
  const RecordedTile& tile;
  ColumnValues at;
  Factors* f;  // [packs]
  L m{0.f}, rest{0.f};
  void begin(std::uint32_t e) {
    m = L(at.m[tile.work.visible[e]]);
    rest = L(at.rest[tile.work.visible[e]]);
  }
  void begin_band(std::size_t) {}
  void add(std::size_t k, float* lane) { f[k].add(weight_in_place(lane, tile.lanes), m, rest); }
  void end_band(std::size_t) {}
  void end() {}
};

template <class Factors>
struct SlotSink {
  const TileWork<float>& work;
  const Factors* f;  // [packs]
  SlotSums* slots;
  std::uint32_t entry = 0;
  L inside{0.f}, outside{0.f}, inside_of[kBands] = {}, outside_of[kBands] = {};
  void begin(std::uint32_t e) {
    entry = e;
    std::fill_n(inside_of, kBands, L(0.f));
    std::fill_n(outside_of, kBands, L(0.f));
  }
  void begin_band(std::size_t) { inside = outside = L(0.f); }
  void add(std::size_t k, const float* lane) {
    L weight;
    load_lanes(lane, weight);
    inside = fma_lanes(weight, f[k].q, inside);
    outside = fma_lanes(weight, f[k].c, outside);
  }
  void end_band(std::size_t band) {
    inside_of[band] = inside;
    outside_of[band] = outside;
  }
  void end() {
    slots[work.slot[entry]] = {sum_lanes(inside_of[0] + inside_of[1]), sum_lanes(outside_of[0] + outside_of[1])};
  }
};

template <class Factors>
TileLoss evaluate_with(const RecordedTile& tile, ColumnValues at, const TileTargets& targets, SlotSums* slots) {
  Factors f[kTilePacks];
  PixelPack pixel[kTilePacks];
  TileLoss out;
  for (std::size_t k = 0; k < kTilePacks; ++k) {
    pixel[k] = {targets.inside[k], targets.outside[k], L(0.f), transmittance_of(tile, k)};
    out.target_sum += double(sum_lanes(pixel[k].inside)) + double(sum_lanes(pixel[k].outside));
    f[k].start(pixel[k]);
  }
  traverse(tile, FactorSink<Factors>{tile, at, f});
  LossSum loss;
  for (std::size_t k = 0; k < kTilePacks; ++k) f[k].divide(pixel[k], loss);
  out.loss = loss.value();
  traverse(tile, SlotSink<Factors>{tile.work, f, slots});
  return out;
}

}  // namespace

TileLoss evaluate_tile(const RecordedTile& tile, ColumnValues at, TargetPlanes planes, SlotSums* slots) {
  const TileTargets targets(tile.work.frame, planes);
  return targets.binary ? evaluate_with<BinaryFactors>(tile, at, targets, slots)
                        : evaluate_with<WeightedFactors>(tile, at, targets, slots);
}

}  // namespace ngs
