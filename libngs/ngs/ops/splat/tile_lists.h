#pragma once
// Tile intersections of a view's Gaussians, in depth order. Internal to ops; templated on the storage scalar S.
#include <algorithm>
#include <array>
#include <bit>
#include <utility>
#include <vector>

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/ops/splat/splat_gaussian.h"
#include "ngs/scene/views.h"

namespace ngs {

/// The tiles that a Gaussian intersects in the first rows of its rectangle; {0, 0} below it. Most have no more rows.
using FirstSpans = std::array<TileSpan, 2>;
inline constexpr int kFirstRows = int(std::tuple_size_v<FirstSpans>);

template <class S>
FirstSpans first_spans(const SplatRecord<S>& record, const TileRect& rect) {
  FirstSpans spans{};
  for (int row = 0; row < std::min(kFirstRows, rect.y_end - rect.y_begin); ++row)
    spans[std::size_t(row)] = tile_span(record, rect, rect.y_begin + row);
  return spans;
}

template <class S>
struct ProjectedView {
  std::vector<std::uint32_t> id;       // [V] index into the cloud, unique
  std::vector<SplatRecord<S>> record;  // [V]
  std::vector<S> depth;                // [V] camera z
  std::vector<TileRect> rect;          // [V] tiles within the compat mode's radius; may be empty
  std::vector<FirstSpans> first;       // [V]

  void reserve(std::size_t n) {
    id.reserve(n);
    record.reserve(n);
    depth.reserve(n);
    rect.reserve(n);
    first.reserve(n);
  }
  void append(const ProjectedView& part) {
    id.insert(id.end(), part.id.begin(), part.id.end());
    record.insert(record.end(), part.record.begin(), part.record.end());
    depth.insert(depth.end(), part.depth.begin(), part.depth.end());
    rect.insert(rect.end(), part.rect.begin(), part.rect.end());
    first.insert(first.end(), part.first.begin(), part.first.end());
  }
};

/// Per tile: the visible Gaussians that reach alpha >= 1/255 in it, nearest first. Slots number the (Gaussian, tile)
/// pairs Gaussian-major: those of visible Gaussian v are [slot_begin[v], slot_begin[v + 1]). So per-pair results are
/// summed per Gaussian in a fixed order.
struct TileLists {
  int tiles_x = 0, tiles_y = 0;
  std::vector<double> last_z;            // [tiles] largest camera z that is listed, 0: none; empty: no limit
  std::vector<std::int64_t> tile_begin;  // [tiles + 1]
  std::vector<std::uint32_t> visible;    // [pairs] index v
  std::vector<std::uint32_t> slot;       // [pairs]
  std::vector<std::int64_t> slot_begin;  // [V + 1]
  std::int64_t pairs() const { return std::int64_t(visible.size()); }
  std::int64_t tiles() const { return std::int64_t(tiles_x) * tiles_y; }
};

/// Adds the rows of `pairs` [pairs, columns], indexed by slot, of visible Gaussian v to sum [columns].
template <class S>
[[gnu::always_inline]] inline void add_slots(const TileLists& lists, std::size_t v, const S* pairs, std::size_t columns,
                                             double* sum) {
  for (std::int64_t slot = lists.slot_begin[v]; slot < lists.slot_begin[v + 1]; ++slot)
    for (std::size_t c = 0; c < columns; ++c) sum[c] += double(pairs[std::size_t(slot) * columns + c]);
}

/// A (Gaussian, tile) pair before sorting.
struct TileEntry {
  std::uint32_t depth;  // bits of the depth: positive floats sort like their bits
  std::uint32_t visible, slot;
};

/// Scratch memory of bin_tiles, reused from view to view.
struct BinScratch {
  static constexpr std::size_t kPaddingTiles = 2;  // count() and put() may touch this many tiles past the last one
  struct Chunk {                                   // consecutive visible Gaussians
    std::vector<TileSpan> span;                    // per Gaussian: the rows of tiles after the first kFirstRows
    std::vector<std::uint32_t> next;               // [tiles + kPaddingTiles] pair count; then next position
    std::uint32_t slots = 0;                       // pair count; then the first slot
  };
  std::vector<Chunk> chunk;
  std::vector<TileEntry> entry;  // [pairs] by tile, then Gaussian
};

/// Orders entries of equal depth by index into the cloud. `at` [count]: (depth, place in `entry`), sorted by depth.
inline void order_equals(const TileEntry* entry, const std::vector<std::uint32_t>& id, std::uint64_t* at,
                         std::uint32_t count) {
  const auto depth = [at](std::uint32_t i) { return at[i] >> 32; };
  const auto index = [&](std::uint64_t a) { return id[entry[std::uint32_t(a)].visible]; };
  for (std::uint32_t i = 0, end = 0; i < count; i = end) {
    for (end = i + 1; end < count && depth(end) == depth(i);) ++end;
    if (end - i > 1) std::sort(at + i, at + end, [&](std::uint64_t a, std::uint64_t b) { return index(a) < index(b); });
  }
}

/// One pass of a stable radix sort: by the 8 bits from `shift` on. Neighbours in the list often have equal digits. With
/// one counter per digit each update would wait for the previous one, so each quarter of the list has its own counters.
inline void sort_by_digit(const std::uint64_t* from, std::uint64_t* to, std::uint32_t count, int shift) {
  constexpr std::uint32_t kQuarters = 4, kValues = 256;
  const std::uint32_t quarter = count / kQuarters;
  std::array<std::array<std::uint32_t, kQuarters>, kValues> next{};  // count; then next position
  const auto digit = [&](std::uint32_t i) { return from[i] >> shift & (kValues - 1); };
  const auto each = [&](const auto& f) {
    for (std::uint32_t i = 0; i < quarter; ++i)
      for (std::uint32_t q = 0; q < kQuarters; ++q) f(i + q * quarter, q);
    for (std::uint32_t i = kQuarters * quarter; i < count; ++i) f(i, kQuarters - 1);
  };
  each([&](std::uint32_t i, std::uint32_t q) { ++next[digit(i)][q]; });
  std::uint32_t at = 0;
  for (auto& of_value : next)
    for (std::uint32_t& n : of_value) at += std::exchange(n, at);
  each([&](std::uint32_t i, std::uint32_t q) { to[next[digit(i)][q]++] = from[i]; });
}

/// Sorts the entries of one tile by (depth, index into the cloud) and writes them to the lists.
inline void sort_tile(const TileEntry* entry, std::uint32_t count, const std::vector<std::uint32_t>& id,
                      std::uint32_t* visible, std::uint32_t* slot) {
  static thread_local std::vector<std::uint64_t> memory;  // depth, place
  if (memory.size() < 2 * std::size_t(count)) memory.resize(2 * std::size_t(count));
  std::uint64_t *from = memory.data(), *to = from + count;
  std::uint32_t least = ~0u, most = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    least = std::min(least, entry[i].depth);
    most = std::max(most, entry[i].depth);
  }
  for (std::uint32_t i = 0; i < count; ++i) from[i] = std::uint64_t(entry[i].depth - least) << 32 | i;
  constexpr std::uint32_t kFew = 128;  // below it a comparison sort is faster
  if (count < kFew) {
    std::sort(from, from + count);
  } else {
    for (int shift = 32; shift < 32 + int(std::bit_width(most - least)); shift += 8) {
      sort_by_digit(from, to, count, shift);
      std::swap(from, to);
    }
  }
  order_equals(entry, id, from, count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const TileEntry& e = entry[std::uint32_t(from[i])];
    visible[i] = e.visible;
    slot[i] = e.slot;
  }
}

/// The tiles that visible Gaussian v intersects in row `ty` of its rectangle.
template <class S>
TileSpan span_of(const ProjectedView<S>& view, std::size_t v, int ty) {
  const int row = ty - view.rect[v].y_begin;
  return row < kFirstRows ? view.first[v][std::size_t(row)] : tile_span(view.record[v], view.rect[v], ty);
}

/// Per tile: camera z of the last Gaussian that intersects it, 0 if none does. `of` [N] 1: only these; null: all.
template <class S>
std::vector<double> last_z_of(const ProjectedView<S>& view, const TileLists& lists, const std::uint8_t* of) {
  std::vector<double> last(std::size_t(lists.tiles()), 0.0);
  for (std::size_t v = 0; v < view.id.size(); ++v) {
    if (of != nullptr && !of[view.id[v]]) continue;
    for (int ty = view.rect[v].y_begin; ty < view.rect[v].y_end; ++ty) {
      const TileSpan span = span_of(view, v, ty);
      double* row = last.data() + std::ptrdiff_t(ty) * lists.tiles_x;
      for (int tx = span.first; tx < span.end; ++tx) row[tx] = std::max(row[tx], double(view.depth[v]));
    }
  }
  return last;
}

/// Per tile: the maximum of a depth image [H, W, 1].
inline std::vector<double> last_z_of(const ImageF& limit, const TileLists& lists) {
  std::vector<double> last(std::size_t(lists.tiles()), 0.0);
  for (int y = 0; y < limit.height_px; ++y)
    for (int x = 0; x < limit.width_px; ++x) {
      double& tile = last[std::size_t(y / kTilePx) * std::size_t(lists.tiles_x) + std::size_t(x / kTilePx)];
      tile = std::max(tile, double(limit.at(x, y, 0)));
    }
  return last;
}

/// Bounding rectangle of the tiles with last_z > 0; empty if there are none.
inline TileRect bounding_rect(const TileLists& lists) {
  TileRect box{0, 0, 0, 0};
  for (int ty = 0; ty < lists.tiles_y; ++ty)
    for (int tx = 0; tx < lists.tiles_x; ++tx) {
      if (!(lists.last_z[std::size_t(ty) * std::size_t(lists.tiles_x) + std::size_t(tx)] > 0)) continue;
      const auto x = std::uint16_t(tx), y = std::uint16_t(ty), right = std::uint16_t(tx + 1),
                 below = std::uint16_t(ty + 1);
      box = box.x_begin >= box.x_end
                ? TileRect{x, right, y, below}
                : TileRect{std::min(box.x_begin, x), std::max(box.x_end, right), box.y_begin, below};
    }
  return box;
}

/// Bins one view; each chunk of the visible Gaussians owns its own range of every tile's list.
template <class S>
class TileBinner {
 public:
  TileBinner(const Exec& exec, const ProjectedView<S>& view, TileLists& lists, BinScratch& scratch)
      : exec_(exec), view_(view), lists_(lists), scratch_(scratch) {}

  void bin() {
    const auto count = std::int64_t(view_.id.size());
    chunks_ = std::max<std::int64_t>(1, exec_.threads);
    per_chunk_ = (count + chunks_ - 1) / chunks_;
    scratch_.chunk.resize(std::size_t(chunks_));
    lists_.slot_begin.resize(std::size_t(count) + 1);
    const bool all = lists_.last_z.empty();
    for_each_task(exec_, chunks_, [&](std::int64_t c) { all ? count_pairs<true>(c) : count_pairs<false>(c); });
    place_tiles();
    for_each_task(exec_, chunks_, [&](std::int64_t c) { all ? scatter<true>(c) : scatter<false>(c); });
    for_each_task(exec_, lists_.tiles(), [&](std::int64_t tile) {
      const auto begin = std::size_t(lists_.tile_begin[std::size_t(tile)]);
      const auto end = std::size_t(lists_.tile_begin[std::size_t(tile) + 1]);
      sort_tile(scratch_.entry.data() + begin, std::uint32_t(end - begin), view_.id, lists_.visible.data() + begin,
                lists_.slot.data() + begin);
    });
  }

 private:
  std::size_t first(std::int64_t c) const {
    return std::size_t(std::min(c * per_chunk_, std::int64_t(view_.id.size())));
  }

  /// The spans of a chunk, its pairs per tile, and slot_begin counted from the chunk's first.
  template <bool kAll>
  void count_pairs(std::int64_t c) {
    BinScratch::Chunk& chunk = scratch_.chunk[std::size_t(c)];
    chunk.span.clear();
    chunk.next.assign(std::size_t(lists_.tiles()) + BinScratch::kPaddingTiles, 0);
    std::uint64_t slots = 0;
    for (std::size_t v = first(c); v < first(c + 1); ++v) {
      lists_.slot_begin[v] = std::int64_t(slots);
      const TileRect& r = view_.rect[v];
      std::uint32_t* next = chunk.next.data() + std::ptrdiff_t(r.y_begin) * lists_.tiles_x;
      int ty = r.y_begin;
      for (const TileSpan span : view_.first[v]) {
        slots += kAll ? count(span, next) : count_needed(v, span, ty, next);
        ++ty;
        next += lists_.tiles_x;
      }
      for (; ty < r.y_end; ++ty, next += lists_.tiles_x) {
        chunk.span.push_back(tile_span(view_.record[v], r, ty));
        slots += kAll ? count(chunk.span.back(), next) : count_needed(v, chunk.span.back(), ty, next);
      }
    }
    NGS_CHECK(slots <= 0xffffffff, "slots are counted in 32 bits");
    chunk.slots = std::uint32_t(slots);
  }

  /// f(tx) for the tiles of a span in row `ty` whose list contains Gaussian v.
  template <class F>
  void for_each_needed(std::size_t v, TileSpan span, int ty, const F& f) const {
    const double depth = double(view_.depth[v]);
    for (int tx = span.first; tx < span.end; ++tx)
      if (depth <= lists_.last_z[std::size_t(ty) * std::size_t(lists_.tiles_x) + std::size_t(tx)]) f(tx);
  }
  std::uint64_t count_needed(std::size_t v, TileSpan span, int ty, std::uint32_t* next) const {
    std::uint64_t tiles = 0;
    for_each_needed(v, span, ty, [&](int tx) {
      ++next[tx];
      ++tiles;
    });
    return tiles;
  }

  /// Counts the tiles of a span. Most spans have one or two tiles, which is unpredictable: branch-free for these.
  static std::uint64_t count(TileSpan span, std::uint32_t* next) {
    const int tiles = span.end - span.first;
    next[span.first] += tiles > 0;
    next[span.first + 1] += tiles > 1;
    for (int tx = span.first + 2; tx < span.end; ++tx) ++next[tx];
    return std::uint64_t(tiles);
  }

  void place_tiles() {
    lists_.tile_begin.resize(std::size_t(lists_.tiles()) + 1);
    std::uint64_t total = 0;
    for (BinScratch::Chunk& chunk : scratch_.chunk) total += std::exchange(chunk.slots, std::uint32_t(total));
    NGS_CHECK(total <= 0xffffffff, "slots are counted in 32 bits");
    std::uint32_t at = 0;
    for (std::size_t tile = 0; tile < std::size_t(lists_.tiles()); ++tile) {
      lists_.tile_begin[tile] = at;
      for (BinScratch::Chunk& chunk : scratch_.chunk) at += std::exchange(chunk.next[tile], at);
    }
    lists_.tile_begin.back() = lists_.slot_begin.back() = std::int64_t(total);
    scratch_.entry.resize(total);
    lists_.visible.resize(total);
    lists_.slot.resize(total);
  }

  template <bool kAll>
  void scatter(std::int64_t c) {
    BinScratch::Chunk& chunk = scratch_.chunk[std::size_t(c)];
    std::uint32_t slot = chunk.slots;
    const TileSpan* later = chunk.span.data();
    for (std::size_t v = first(c); v < first(c + 1); ++v) {
      lists_.slot_begin[v] += chunk.slots;
      const TileRect& r = view_.rect[v];
      const auto depth = std::bit_cast<std::uint32_t>(float(double(view_.depth[v])));
      TileEntry entry{depth, std::uint32_t(v), slot};
      std::uint32_t* next = chunk.next.data() + std::ptrdiff_t(r.y_begin) * lists_.tiles_x;
      int ty = r.y_begin;
      for (const TileSpan span : view_.first[v]) {
        put<kAll>(span, ty++, next, entry);
        next += lists_.tiles_x;
      }
      for (; ty < r.y_end; ++ty, next += lists_.tiles_x) put<kAll>(*later++, ty, next, entry);
      slot = entry.slot;
    }
  }

  /// Writes the entries of a span of row `ty`, from entry.slot on. As count(), branch-free for the first two tiles.
  template <bool kAll>
  void put(TileSpan span, int ty, std::uint32_t* next, TileEntry& entry) {
    if (!kAll)
      return for_each_needed(entry.visible, span, ty, [&](int tx) {
        scratch_.entry[next[tx]++] = entry;
        ++entry.slot;
      });
    TileEntry nowhere, *const to = scratch_.entry.data();
    const int tiles = span.end - span.first;
    const std::uint32_t at[2] = {next[span.first], next[span.first + 1]}, slot = entry.slot;
    *(tiles > 0 ? to + at[0] : &nowhere) = entry;
    next[span.first] = at[0] + (tiles > 0);
    entry.slot = slot + 1;
    *(tiles > 1 ? to + at[1] : &nowhere) = entry;
    next[span.first + 1] = at[1] + (tiles > 1);
    for (int tx = span.first + 2; tx < span.end; ++tx) {
      ++entry.slot;
      to[next[tx]++] = entry;
    }
    entry.slot = slot + std::uint32_t(tiles);
  }

  const Exec& exec_;
  const ProjectedView<S>& view_;
  TileLists& lists_;
  BinScratch& scratch_;
  std::int64_t chunks_ = 1, per_chunk_ = 0;
};

/// Fills `lists` in depth order: (depth, index into the cloud). lists.tiles_x, tiles_y and last_z are inputs.
template <class S>
void bin_tiles(const Exec& exec, const ProjectedView<S>& view, TileLists& lists, BinScratch& scratch) {
  TileBinner<S>(exec, view, lists, scratch).bin();
}

}  // namespace ngs
