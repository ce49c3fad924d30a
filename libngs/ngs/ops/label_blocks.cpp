#include "ngs/ops/label_blocks.h"

#include "ngs/ops/loss_mask_kernels.h"

namespace ngs {
namespace {

using L = LabelPack;
constexpr std::size_t kTilePacks = std::size_t(kLabelPacks);
constexpr std::size_t kAhead = 32;  // packs: what a walk asks memory for before it needs them

L quotient(L a, L b) { return L(a.v / b.v); }

L squeezed(L sum) { return fma_lanes(L(float(1 - 2 * kMaskEps)), sum, L(float(kMaskEps))); }

/// -Σ a ln q + b ln c. A logarithm is taken of products of 32 factors, each >= 1e-6: 4 in float, 8 of these in double.
class LossSum {
 public:
  LossSum() { std::fill_n(product_, L::kLanes, 1.0); }

  void add(const PixelPack& p, bool binary) {
    const L fore = squeezed(p.foreground), back = squeezed(p.background);
    binary ? add_binary(p, select(p.inside > L(0.f), fore, back)) : add_weighted(p, fore, back);
  }
  /// Binary targets select one factor per pixel, or none.
  void add_binary(const PixelPack& p, L factor) {
    factor_ = factor_ * select(p.inside + p.outside > L(0.f), factor, L(1.f));
    if (++factors_ % 4 == 0) fold();
  }
  void add_weighted(const PixelPack& p, L q, L c) {
    float inside[L::kLanes], outside[L::kLanes], fore[L::kLanes], back[L::kLanes];
    store_lanes(inside, p.inside), store_lanes(outside, p.outside), store_lanes(fore, q), store_lanes(back, c);
    for (int i = 0; i < L::kLanes; ++i) {
      if (inside[i] != 0.f) weighted_ -= double(inside[i]) * std::log(double(fore[i]));
      if (outside[i] != 0.f) weighted_ -= double(outside[i]) * std::log(double(back[i]));
    }
  }
  double value() {
    fold();
    double sum = weighted_;
    for (const double p : product_) sum -= std::log(p);
    return sum;
  }

 private:
  void fold() {
    float lane[L::kLanes];
    store_lanes(lane, factor_);
    for (int i = 0; i < L::kLanes; ++i) product_[i] *= double(lane[i]);
    factor_ = L(1.f);
  }

  int factors_ = 0;
  L factor_{1.f};
  double product_[L::kLanes], weighted_ = 0;
};

/// The targets of one tile in packs, 0 outside the image.
struct TileTargets {
  L inside[kTilePacks], outside[kTilePacks];
  bool binary = true;

  TileTargets(const TileFrame& frame, TargetPlanes planes) {
    float lane[2][kTilePacks * L::kLanes] = {};
    for (int y = 0; y < frame.rows(); ++y)
      for (int x = 0; x < frame.columns(); ++x) {
        const auto pixel =
            std::size_t(frame.y_px + y) * std::size_t(frame.width_px) + std::size_t(frame.x_px + x);
        const auto at = std::size_t(place_in_packs<L>(x, y));
        const float a = planes.inside[pixel], b = planes.outside[pixel];
        lane[0][at] = a, lane[1][at] = b;
        binary &= (a == 0.f || a == 1.f) && (b == 0.f || b == 1.f) && a * b == 0.f;
      }
    for (std::size_t k = 0; k < kTilePacks; ++k)
      load_lanes(&lane[0][k * L::kLanes], inside[k]), load_lanes(&lane[1][k * L::kLanes], outside[k]);
  }
};

L wide(const L& w) { return w; }
L wide(const HalfPack& w) { return w.wide(); }

/// Both factors of every pixel, q and c, then a / q and b / c.
struct WeightedFactors {
  L q[kTilePacks], c[kTilePacks];
  void start(std::size_t k, const PixelPack& p) { q[k] = p.foreground, c[k] = p.background; }
  void add(std::size_t k, L weight, L m, L rest) {
    q[k] = fma_lanes(weight, m, q[k]), c[k] = fma_lanes(weight, rest, c[k]);
  }
  void divide(std::size_t k, const PixelPack& p, LossSum& loss) {
    const L fore = squeezed(q[k]), back = squeezed(c[k]);
    loss.add_weighted(p, fore, back);
    q[k] = quotient(p.inside, fore), c[k] = quotient(p.outside, back);
  }
};

/// Binary targets: only the factor that a pixel's target takes, in q until it is divided.
struct BinaryFactors {
  L q[kTilePacks], c[kTilePacks], inside[kTilePacks];
  void start(std::size_t k, const PixelPack& p) {
    inside[k] = p.inside;
    q[k] = select(p.inside > L(0.f), p.foreground, p.background);
  }
  void add(std::size_t k, L weight, L m, L rest) {
    q[k] = fma_lanes(weight, select(inside[k] > L(0.f), m, rest), q[k]);
  }
  void divide(std::size_t k, const PixelPack& p, LossSum& loss) {
    const L factor = squeezed(q[k]);
    loss.add_binary(p, factor);
    const L inverse = quotient(L(1.f), factor);
    q[k] = p.inside * inverse, c[k] = p.outside * inverse;
  }
};

/// Σ w x in two sums that take turns, so that none waits for its last addend.
class TurnSum {
 public:
  void add(L weight, L x) {
    const L to = fma_lanes(weight, x, turn_);
    turn_ = other_, other_ = to;
  }
  float value() const { return sum_lanes(turn_ + other_); }

 private:
  L turn_{0.f}, other_{0.f};
};

template <class Factors, class Weights>
double evaluate_with(const LabelBlock& block, const Weights& weight, ColumnValues at, SlotSums* slots) {
  Factors f;
  for (std::size_t k = 0; k < block.pixel.size(); ++k) f.start(k, block.pixel[k]);
  std::size_t i = 0;
  for (const LabelBlock::Entry& e : block.entry) {
    const L m(at.m[e.column]), rest(at.rest[e.column]);
    for (const std::size_t end = i + e.packs; i < end; ++i) {
      __builtin_prefetch(&weight[i] + kAhead);
      f.add(block.pack[i], wide(weight[i]), m, rest);
    }
  }
  LossSum loss;
  for (std::size_t k = 0; k < block.pixel.size(); ++k) f.divide(k, block.pixel[k], loss);
  i = 0;
  for (const LabelBlock::Entry& e : block.entry) {
    TurnSum inside, outside;
    for (const std::size_t end = i + e.packs; i < end; ++i) {
      const std::size_t k = block.pack[i];
      inside.add(wide(weight[i]), f.q[k]), outside.add(wide(weight[i]), f.c[k]);
    }
    slots[e.slot] = {inside.value(), outside.value()};
  }
  return loss.value();
}

template <class Weights>
double evaluate_block(const LabelBlock& block, const Weights& weight, ColumnValues at, SlotSums* slots) {
  return block.binary ? evaluate_with<BinaryFactors>(block, weight, at, slots)
                      : evaluate_with<WeightedFactors>(block, weight, at, slots);
}

}  // namespace

double evaluate_block(const LabelBlock& block, ColumnValues at, SlotSums* slots) {
  return block.half.empty() ? evaluate_block(block, block.weight, at, slots)
                            : evaluate_block(block, block.half, at, slots);
}

namespace {

/// The contributions of a tile in packs of 8 pixels: of each entry first those of columns 0 to 7, then the others.
/// sink.begin(entry), sink.add(pack, [lanes] of alpha, then of transmittance `lanes` later), sink.end().
template <class Sink>
void walk(const RecordedTile& tile, Sink&& sink) {
  const Tape<float>& tape = tile.tape;
  for (std::size_t k = 0; k < tape.spans;) {
    const std::uint32_t entry = tape.span[k].entry;
    sink.begin(entry);
    for (; k < tape.spans && tape.span[k].entry == entry; ++k) {
      const std::size_t stop = k + 1 < tape.spans ? tape.span[k + 1].begin : tape.size;
      for (int half = 0; half < tile.lanes; half += L::kLanes)
        for (std::size_t j = tape.span[k].begin; j < stop; ++j) {
          float* lane = tape.lanes + j * std::size_t(2 * tile.lanes) + half;
          L reached;
          load_lanes(lane, reached);
          if (!any(reached > L(0.f))) continue;
          const int column = int(tape.span[k].column) * (tile.lanes / L::kLanes) + half / L::kLanes;
          sink.add(std::size_t(column * kTilePx + tape.row[j]), lane);
        }
    }
    sink.end();
  }
}

/// The weight of a contribution, kept where its alpha was.
L weight_in_place(float* lane, int lanes) {
  L alpha, before;
  load_lanes(lane, alpha), load_lanes(lane + lanes, before);
  const L weight = alpha * before;
  store_lanes(lane, weight);
  return weight;
}

/// What is left behind the tile's Gaussians; wider packs hold the columns of two of ours side by side.
L transmittance_of(const RecordedTile& tile, std::size_t pack) {
  const int column = int(pack) / kTilePx * L::kLanes, row = int(pack) % kTilePx;
  L behind;
  load_lanes(tile.transmittance + (column / tile.lanes * kTilePx + row) * tile.lanes + column % tile.lanes, behind);
  return behind;
}

template <class Factors>
struct FactorSink {
  const RecordedTile& tile;
  ColumnValues at;
  Factors& f;
  L m{0.f}, rest{0.f};
  void begin(std::uint32_t e) { m = L(at.m[tile.work.visible[e]]), rest = L(at.rest[tile.work.visible[e]]); }
  void add(std::size_t k, float* lane) { f.add(k, weight_in_place(lane, tile.lanes), m, rest); }
  void end() {}
};

template <class Factors>
struct SlotSink {
  const TileWork<float>& work;
  const Factors& f;
  SlotSums* slots;
  std::uint32_t entry = 0;
  TurnSum inside{}, outside{};
  void begin(std::uint32_t e) { entry = e, inside = outside = TurnSum(); }
  void add(std::size_t k, const float* lane) {
    L weight;
    load_lanes(lane, weight);
    inside.add(weight, f.q[k]), outside.add(weight, f.c[k]);
  }
  void end() { slots[work.slot[entry]] = {inside.value(), outside.value()}; }
};

template <class Factors>
TileLoss evaluate_with(const RecordedTile& tile, ColumnValues at, const TileTargets& targets, SlotSums* slots) {
  Factors f;
  PixelPack pixel[kTilePacks];
  TileLoss out;
  for (std::size_t k = 0; k < kTilePacks; ++k) {
    pixel[k] = {targets.inside[k], targets.outside[k], L(0.f), transmittance_of(tile, k)};
    out.target_sum += double(sum_lanes(pixel[k].inside)) + double(sum_lanes(pixel[k].outside));
    f.start(k, pixel[k]);
  }
  walk(tile, FactorSink<Factors>{tile, at, f});
  LossSum loss;
  for (std::size_t k = 0; k < kTilePacks; ++k) f.divide(k, pixel[k], loss);
  out.loss = loss.value();
  walk(tile, SlotSink<Factors>{tile.work, f, slots});
  return out;
}

/// Collects the weights of columns and folds those of the other Gaussians.
struct WeightSink {
  static constexpr bool kTakesEmpty = false;
  const TileWork<float>& work;
  LabelPlaces places;
  bool half;
  LabelBlock& block;
  L foreground[kTilePacks], background[kTilePacks];
  bool reached[kTilePacks] = {};
  bool is_column = false;
  L m{0.f}, rest{0.f};

  void begin(std::uint32_t e) {
    const std::uint32_t gaussian = places.id[work.visible[e]];
    is_column = places.column[gaussian] >= 0;
    if (is_column) block.entry.push_back({std::uint32_t(places.column[gaussian]), work.slot[e], 0});
    const double label = places.label[gaussian];
    m = L(float(label)), rest = L(float(1 - label));
  }
  void begin_column(int) {}
  void add(int, const Contribution<L>& hit) {
    const auto k = std::size_t(hit.pack);
    const L weight = hit.alpha * hit.transmittance;
    if (!is_column) {
      foreground[k] = fma_lanes(weight, m, foreground[k]), background[k] = fma_lanes(weight, rest, background[k]);
      return;
    }
    if (half)
      block.half.emplace_back(weight);
    else
      block.weight.push_back(weight);
    block.pack.push_back(std::uint8_t(k)), ++block.entry.back().packs;
    reached[k] = true;
  }
  void end_column(int) {}
  void end() {
    if (is_column && block.entry.back().packs == 0) block.entry.pop_back();
  }
};

}  // namespace

TileLoss evaluate_tile(const RecordedTile& tile, ColumnValues at, TargetPlanes planes, SlotSums* slots) {
  const TileTargets targets(tile.work.frame, planes);
  return targets.binary ? evaluate_with<BinaryFactors>(tile, at, targets, slots)
                        : evaluate_with<WeightedFactors>(tile, at, targets, slots);
}

void collect_block(const TileWork<float>& work, LabelPlaces places, TargetPlanes planes, bool half, LabelBlock& out) {
  out.clear();
  const TileTargets targets(work.frame, planes);
  out.binary = targets.binary;
  L transmittance[kTilePacks];
  WeightSink sink{work, places, half, out, {}, {}};
  std::fill_n(sink.foreground, kTilePacks, L(0.f)), std::fill_n(sink.background, kTilePacks, L(0.f));
  composite_tile<L>(work, transmittance, sink);
  std::uint8_t place[kTilePacks] = {};
  LossSum constant;
  for (std::size_t k = 0; k < kTilePacks; ++k) {
    const L a = targets.inside[k], b = targets.outside[k];
    out.target_sum += double(sum_lanes(a)) + double(sum_lanes(b));
    const PixelPack pixel{a, b, sink.foreground[k], sink.background[k] + transmittance[k]};
    if (!sink.reached[k]) {
      constant.add(pixel, out.binary);
      continue;
    }
    place[k] = std::uint8_t(out.pixel.size());
    out.pixel.push_back(pixel);
  }
  out.constant_loss = constant.value();
  for (std::uint8_t& k : out.pack) k = place[k];
}

LabelBlock reduced_block(const LabelBlock& block, const std::int32_t* new_column, ColumnValues at) {
  LabelBlock out;
  out.binary = block.binary;
  std::vector<PixelPack> pixel = block.pixel;
  bool reached[kTilePacks] = {};
  std::size_t i = 0, kept = 0;
  for (const LabelBlock::Entry& e : block.entry) kept += new_column[e.column] >= 0 ? e.packs : 0;
  const bool half = !block.half.empty();
  half ? out.half.reserve(kept) : out.weight.reserve(kept);
  out.pack.reserve(kept);
  for (const LabelBlock::Entry& e : block.entry) {
    const std::size_t end = i + e.packs;
    if (new_column[e.column] >= 0) {
      out.entry.push_back({std::uint32_t(new_column[e.column]), e.slot, e.packs});
      if (half)
        out.half.insert(out.half.end(), block.half.begin() + std::ptrdiff_t(i), block.half.begin() + std::ptrdiff_t(end));
      else
        out.weight.insert(out.weight.end(), block.weight.begin() + std::ptrdiff_t(i),
                          block.weight.begin() + std::ptrdiff_t(end));
      out.pack.insert(out.pack.end(), block.pack.begin() + std::ptrdiff_t(i),
                      block.pack.begin() + std::ptrdiff_t(end));
      for (; i < end; ++i) reached[block.pack[i]] = true;
      continue;
    }
    const L m(at.m[e.column]), rest(at.rest[e.column]);
    for (; i < end; ++i) {
      PixelPack& p = pixel[block.pack[i]];
      const L weight = half ? block.half[i].wide() : block.weight[i];
      p.foreground = fma_lanes(weight, m, p.foreground),
      p.background = fma_lanes(weight, rest, p.background);
    }
  }
  std::uint8_t place[kTilePacks] = {};
  LossSum constant;
  for (std::size_t k = 0; k < pixel.size(); ++k) {
    if (reached[k])
      place[k] = std::uint8_t(out.pixel.size()), out.pixel.push_back(pixel[k]);
    else
      constant.add(pixel[k], out.binary);
  }
  out.constant_loss = constant.value();
  for (std::uint8_t& k : out.pack) k = place[k];
  return out;
}

}  // namespace ngs
