#include "ngs/ops/label_blocks.h"

#include "ngs/ops/label_system.h"

namespace ngs {
namespace {

using L = LabelPack;
constexpr std::size_t kTilePacks = std::size_t(kLabelPacks);

L quotient(L a, L b) { return L(a.v / b.v); }

L squeezed(L sum) { return fma_lanes(L(float(1 - 2 * kMaskEps)), sum, L(float(kMaskEps))); }

/// -Σ a ln q + b ln c. Binary targets select one factor per pixel; a logarithm is taken of products of 32
/// factors, each >= 1e-6: 4 in float, 8 of these in double.
class LossSum {
 public:
  explicit LossSum(bool binary) : binary_(binary) { std::fill_n(product_, L::kLanes, 1.0); }

  void add(L a, L b, L q, L c) {
    if (!binary_) return add_weighted(a, b, q, c);
    factor_ = factor_ * select(a > L(0.f), q, select(b > L(0.f), c, L(1.f)));
    if (++factors_ % 4 == 0) fold();
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
  void add_weighted(L a, L b, L q, L c) {
    float inside[L::kLanes], outside[L::kLanes], fore[L::kLanes], back[L::kLanes];
    store_lanes(inside, a), store_lanes(outside, b), store_lanes(fore, q), store_lanes(back, c);
    for (int i = 0; i < L::kLanes; ++i) {
      if (inside[i] != 0.f) weighted_ -= double(inside[i]) * std::log(double(fore[i]));
      if (outside[i] != 0.f) weighted_ -= double(outside[i]) * std::log(double(back[i]));
    }
  }

  bool binary_;
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

/// Collects the weights of columns and folds those of the other Gaussians.
struct WeightSink {
  static constexpr bool kTakesEmpty = false;
  const TileWork<float>& work;
  const ProjectedView<float>& view;
  LabelPlaces places;
  const TileTargets& targets;
  float* against;
  LabelBlock& block;
  L foreground[kTilePacks], background[kTilePacks];
  bool reached[kTilePacks] = {};
  bool is_column = false;
  std::uint32_t slot = 0;
  const L* against_target = nullptr;
  L m{0.f}, rest{0.f}, against_sum{0.f};

  void begin(std::uint32_t e) {
    const std::uint32_t gaussian = view.id[work.visible[e]];
    slot = work.slot[e];
    is_column = places.column[gaussian] >= 0;
    if (is_column) {
      block.entry.push_back({std::uint32_t(places.column[gaussian]), slot, 0});
      return;
    }
    const double label = places.label[gaussian];
    m = L(float(label)), rest = L(float(1 - label)), against_sum = L(0.f);
    against_target = label >= 0.5 ? targets.outside : targets.inside;
  }
  void begin_column(int) {}
  void add(int, const Contribution<L>& hit) {
    const L weight = hit.alpha * hit.transmittance;
    const auto k = std::size_t(hit.pack);
    if (is_column) {
      block.pack.push_back(std::uint8_t(hit.pack)), block.weight.push_back(weight);
      reached[k] = true;
      return;
    }
    foreground[k] = fma_lanes(weight, m, foreground[k]),
    background[k] = fma_lanes(weight, rest, background[k]);
    against_sum = fma_lanes(weight, against_target[k], against_sum);
  }
  void end_column(int) {}
  void end() {
    if (!is_column) {
      if (against) against[slot] = sum_lanes(against_sum);
      return;
    }
    const std::size_t before = entry_end;
    entry_end = block.weight.size();
    block.entry.back().packs = std::uint32_t(entry_end - before);
    if (entry_end == before) block.entry.pop_back();
  }
  std::size_t entry_end = 0;
};

}  // namespace

namespace {

L wide(const L& w) { return w; }
L wide(const HalfPack& w) { return w.wide(); }

template <class Weights>
double evaluate_with(const LabelBlock& block, const Weights& weight, ColumnValues at, SlotSums* slots) {
  L q[kTilePacks], c[kTilePacks];
  for (std::size_t k = 0; k < block.pixel.size(); ++k)
    q[k] = block.pixel[k].foreground, c[k] = block.pixel[k].background;
  std::size_t i = 0;
  for (const LabelBlock::Entry& e : block.entry) {
    const L m(at.m[e.column]), rest(at.rest[e.column]);
    for (const std::size_t end = i + e.packs; i < end; ++i) {
      const std::uint8_t k = block.pack[i];
      q[k] = fma_lanes(wide(weight[i]), m, q[k]), c[k] = fma_lanes(wide(weight[i]), rest, c[k]);
    }
  }
  LossSum loss(block.binary);
  for (std::size_t k = 0; k < block.pixel.size(); ++k) {
    const L fore = squeezed(q[k]), back = squeezed(c[k]), a = block.pixel[k].inside,
            b = block.pixel[k].outside;
    loss.add(a, b, fore, back);
    q[k] = quotient(a, fore), c[k] = quotient(b, back);
  }
  i = 0;
  for (const LabelBlock::Entry& e : block.entry) {
    L inside(0.f), outside(0.f);
    for (const std::size_t end = i + e.packs; i < end; ++i) {
      const std::uint8_t k = block.pack[i];
      inside = fma_lanes(wide(weight[i]), q[k], inside), outside = fma_lanes(wide(weight[i]), c[k], outside);
    }
    slots[e.slot] = {sum_lanes(inside), sum_lanes(outside)};
  }
  return loss.value();
}

}  // namespace

double evaluate_block(const LabelBlock& block, ColumnValues at, SlotSums* slots) {
  return block.half.empty() ? evaluate_with(block, block.weight, at, slots)
                            : evaluate_with(block, block.half, at, slots);
}

namespace {

/// The packs of 8 pixels in a tape of packs of 8 or 16: of each entry first those of columns 0 to 7, then the others.
/// f(entry, pack, weight lanes) per contribution; `end(entry)` after the last of an entry.
template <class F, class End>
void for_each_half(const Tape<float>& tape, int lanes, const F& f, const End& end) {
  for (std::size_t k = 0; k < tape.spans;) {
    const std::uint32_t entry = tape.span[k].entry;
    for (; k < tape.spans && tape.span[k].entry == entry; ++k) {
      const std::size_t stop = k + 1 < tape.spans ? tape.span[k + 1].begin : tape.size;
      for (int half = 0; half < lanes; half += L::kLanes)
        for (std::size_t j = tape.span[k].begin; j < stop; ++j)
          f(entry, (int(tape.span[k].column) * (lanes / L::kLanes) + half / L::kLanes) * kTilePx + tape.row[j],
            tape.lanes + j * std::size_t(2 * lanes) + half);
    }
    end(entry);
  }
}

}  // namespace

TileLoss evaluate_tape(const TileWork<float>& work, Tape<float>& tape, int lanes, const float* transmittance,
                       ColumnValues at, TargetPlanes planes, SlotSums* slots) {
  const TileTargets targets(work.frame, planes);
  L q[kTilePacks], c[kTilePacks];
  for (int pack = 0; pack < kLabelPacks; ++pack) {  // wider packs hold the columns of two of ours side by side
    const int column = pack / kTilePx * L::kLanes, row = pack % kTilePx;
    q[pack] = L(0.f);
    load_lanes(transmittance + (column / lanes * kTilePx + row) * lanes + column % lanes, c[pack]);
  }
  for_each_half(
      tape, lanes,
      [&](std::uint32_t e, int pack, float* lane) {
        L alpha, before;
        load_lanes(lane, alpha), load_lanes(lane + lanes, before);
        const L weight = alpha * before;
        store_lanes(lane, weight);
        const std::uint32_t v = work.visible[e];
        q[pack] = fma_lanes(weight, L(at.m[v]), q[pack]), c[pack] = fma_lanes(weight, L(at.rest[v]), c[pack]);
      },
      [](std::uint32_t) {});
  TileLoss out;
  LossSum loss(targets.binary);
  for (std::size_t k = 0; k < kTilePacks; ++k) {
    const L a = targets.inside[k], b = targets.outside[k], fore = squeezed(q[k]), back = squeezed(c[k]);
    out.target_sum += double(sum_lanes(a)) + double(sum_lanes(b));
    loss.add(a, b, fore, back);
    q[k] = quotient(a, fore), c[k] = quotient(b, back);
  }
  out.loss = loss.value();
  L inside(0.f), outside(0.f);
  for_each_half(
      tape, lanes,
      [&](std::uint32_t, int pack, const float* lane) {
        L weight;
        load_lanes(lane, weight);
        inside = fma_lanes(weight, q[pack], inside), outside = fma_lanes(weight, c[pack], outside);
      },
      [&](std::uint32_t e) {
        slots[work.slot[e]] = {sum_lanes(inside), sum_lanes(outside)};
        inside = outside = L(0.f);
      });
  return out;
}

LabelBlock kept_block(const LabelBlock& block, bool half) {
  if (!half) return block;
  LabelBlock out;
  out.entry = block.entry, out.pack = block.pack, out.pixel = block.pixel;
  out.constant_loss = block.constant_loss, out.target_sum = block.target_sum, out.binary = block.binary;
  out.half.reserve(block.weight.size());
  for (const L& w : block.weight) out.half.emplace_back(w);
  return out;
}

void collect_block(const TileLists& lists, std::int64_t tile, const ProjectedView<float>& view,
                   const Camera& camera, Compat compat, LabelPlaces places, TargetPlanes planes,
                   float* against, LabelBlock& out) {
  out.clear();
  const TileWork<float> work = tile_work(view, lists, tile, camera, compat);
  const TileTargets targets(work.frame, planes);
  out.binary = targets.binary;
  L transmittance[kTilePacks];
  WeightSink sink{work, view, places, targets, against, out, {}, {}};
  std::fill_n(sink.foreground, kTilePacks, L(0.f)), std::fill_n(sink.background, kTilePacks, L(0.f));
  composite_tile<L>(work, transmittance, sink);
  std::uint8_t place[kTilePacks] = {};
  LossSum constant(out.binary);
  for (std::size_t k = 0; k < kTilePacks; ++k) {
    const L a = targets.inside[k], b = targets.outside[k];
    out.target_sum += double(sum_lanes(a)) + double(sum_lanes(b));
    const PixelPack pixel{a, b, sink.foreground[k], sink.background[k] + transmittance[k]};
    if (!sink.reached[k]) {
      constant.add(a, b, squeezed(pixel.foreground), squeezed(pixel.background));
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
  LossSum constant(out.binary);
  for (std::size_t k = 0; k < pixel.size(); ++k) {
    if (reached[k])
      place[k] = std::uint8_t(out.pixel.size()), out.pixel.push_back(pixel[k]);
    else
      constant.add(pixel[k].inside, pixel[k].outside, squeezed(pixel[k].foreground),
                   squeezed(pixel[k].background));
  }
  out.constant_loss = constant.value();
  for (std::uint8_t& k : out.pack) k = place[k];
  return out;
}

}  // namespace ngs
