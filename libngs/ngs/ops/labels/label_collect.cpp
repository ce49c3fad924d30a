#include "ngs/ops/labels/label_packs.h"
#include "ngs/ops/labels/label_system.h"

namespace ngs {
namespace {

using namespace label;

constexpr std::uint32_t kMaxByteStep = 255;  // of places, in one byte

/// Appends contributions to the last pack of a block.
class PackWriter {
 public:
  PackWriter(LabelBlock& block, bool half, std::size_t packs, std::size_t contributions) : block_(block), half_(half) {
    block.pixel.reserve(packs);
    block.end.reserve(packs);
    block.step.reserve(contributions);
    half ? block.half.reserve(contributions) : block.weight.reserve(contributions);
  }
  void add(std::uint32_t place, L weight) {
    for (; place - last_ > kMaxByteStep; last_ += kMaxByteStep) push(kMaxByteStep, L(0.f));
    push(place - last_, weight);
    last_ = place;
  }
  void end_pack(const PixelPack& pixel) {
    block_.pixel.push_back(pixel);
    block_.end.push_back(std::uint32_t(block_.step.size()));
    last_ = 0;
  }

 private:
  void push(std::uint32_t step, L weight) {
    block_.step.push_back(std::uint8_t(step));
    if (half_)
      block_.half.emplace_back(weight);
    else
      block_.weight.push_back(weight);
  }
  LabelBlock& block_;
  bool half_;
  std::uint32_t last_ = 0;
};

/// The contributions of a tile's columns in the order of the traversal. One per thread; its memory grows and is reused.
struct Contributions {
  struct Part {
    std::uint32_t place, pack;
  };
  std::vector<LabelBlock::Entry> entry;
  std::vector<L> weight;
  std::vector<Part> part;
  std::size_t size = 0;
  void clear(std::size_t most) {
    entry.clear();
    size = 0;
    if (part.size() < most) {
      weight.resize(most);
      part.resize(most);
    }
  }
};

/// Collects the weights of columns and folds those of the other Gaussians.
struct WeightSink {
  const RecordedTile& tile;
  LabelPlaces places;
  Contributions& found;
  L *foreground, *background;  // [packs]
  bool is_column = false;
  std::uint32_t next = 0;
  L m{0.f}, rest{0.f};

  void begin(std::uint32_t e) {
    const std::uint32_t gaussian = places.id[tile.work.visible[e]];
    is_column = places.column[gaussian] >= 0;
    next = kBands * std::uint32_t(found.entry.size());
    if (is_column) found.entry.push_back({std::uint32_t(places.column[gaussian]), tile.work.slot[e]});
    const double label = places.label[gaussian];
    m = L(float(label));
    rest = L(float(1 - label));
  }
  void begin_band(std::size_t) {}
  void add(std::size_t k, const float* lane) {
    L alpha, before;
    load_lanes(lane, alpha);
    load_lanes(lane + tile.lanes, before);
    if (!any(alpha > L(0.f))) return;
    const L weight = alpha * before;
    if (!is_column) {
      foreground[k] = fma_lanes(weight, m, foreground[k]);
      background[k] = fma_lanes(weight, rest, background[k]);
      return;
    }
    found.weight[found.size] = weight;
    found.part[found.size++] = {next + std::uint32_t(k) / kTilePx, std::uint32_t(k)};
  }
  void end_band(std::size_t) {}
  void end() {
    if (is_column && (found.size == 0 || found.part[found.size - 1].place < next)) found.entry.pop_back();
  }
};

/// The contributions of each pack, in the order of the traversal.
struct PackOrder {
  std::vector<std::uint32_t> order;  // [contributions]
  std::uint32_t end[kTilePacks];
  std::size_t reached = 0;  // packs

  explicit PackOrder(const Contributions& found) : order(found.size) {
    std::uint32_t next[kTilePacks] = {}, total = 0;
    for (std::size_t i = 0; i < found.size; ++i) ++next[found.part[i].pack];
    for (std::size_t k = 0; k < kTilePacks; ++k) {
      const std::uint32_t count = next[k];
      next[k] = total;
      end[k] = total += count;
      reached += count > 0;
    }
    for (std::size_t i = 0; i < found.size; ++i) order[next[found.part[i].pack]++] = std::uint32_t(i);
  }
};

}  // namespace

LabelBlock collect_block(const RecordedTile& tile, LabelPlaces places, TargetPlanes planes, bool half) {
  static thread_local Contributions found;
  found.clear(tile.tape.size * std::size_t(tile.lanes / L::kLanes));
  const TileTargets targets(tile.work.frame, planes);
  L foreground[kTilePacks], background[kTilePacks];
  std::fill_n(foreground, kTilePacks, L(0.f));
  std::fill_n(background, kTilePacks, L(0.f));
  traverse(tile, WeightSink{tile, places, found, foreground, background});

  LabelBlock out;
  out.binary = targets.binary;
  out.entry = found.entry;
  const PackOrder packs(found);
  PackWriter writer(out, half, packs.reached, found.size);
  LossSum constant;
  std::size_t i = 0;
  for (std::size_t k = 0; k < kTilePacks; ++k) {
    const L a = targets.inside[k], b = targets.outside[k];
    out.target_sum += double(sum_lanes(a)) + double(sum_lanes(b));
    const PixelPack pixel{a, b, foreground[k], background[k] + transmittance_of(tile, k)};
    if (i == packs.end[k]) {
      constant.add(pixel, out.binary);
      continue;
    }
    for (; i < packs.end[k]; ++i) writer.add(found.part[packs.order[i]].place, found.weight[packs.order[i]]);
    writer.end_pack(pixel);
  }
  out.constant_loss = constant.value();
  return out;
}

namespace {

template <class Weight>
void fold_columns(const LabelBlock& block, const Weight* weight, const std::int32_t* new_column, ColumnValues at,
                  LabelBlock& out) {
  std::vector<std::uint32_t> place(block.entry.size(), 0);  // of the remaining columns
  for (std::size_t e = 0; e < block.entry.size(); ++e) {
    const std::int32_t column = new_column[block.entry[e].column];
    if (column < 0) continue;
    place[e] = kBands * std::uint32_t(out.entry.size());
    out.entry.push_back({std::uint32_t(column), block.entry[e].slot});
  }
  PackWriter writer(out, std::is_same_v<Weight, HalfPack>, block.pixel.size(), block.step.size());
  LossSum constant;
  std::size_t begin = 0;
  for (std::size_t k = 0; k < block.pixel.size(); ++k) {
    PixelPack pixel = block.pixel[k];
    const std::size_t size_before = out.step.size();
    for_each_place(block, begin, block.end[k], [&](std::size_t from, std::size_t i) {
      const std::uint32_t column = block.entry[from / kBands].column;
      const L w = wide(weight[i]);
      if (new_column[column] >= 0) {
        return writer.add(place[from / kBands] + std::uint32_t(from % kBands), w);
      }
      pixel.foreground = fma_lanes(w, L(at.m[column]), pixel.foreground);
      pixel.background = fma_lanes(w, L(at.rest[column]), pixel.background);
    });
    if (out.step.size() > size_before)
      writer.end_pack(pixel);
    else
      constant.add(pixel, out.binary);
    begin = block.end[k];
  }
  out.constant_loss = constant.value();
  out.pixel.shrink_to_fit();
  out.step.shrink_to_fit();
  out.weight.shrink_to_fit();
  out.half.shrink_to_fit();
}

}  // namespace

LabelBlock reduced_block(const LabelBlock& block, const std::int32_t* new_column, ColumnValues at) {
  LabelBlock out;
  out.binary = block.binary;
  block.half.empty() ? fold_columns(block, block.weight.data(), new_column, at, out)
                     : fold_columns(block, block.half.data(), new_column, at, out);
  return out;
}

}  // namespace ngs
