#include "ngs/ops/splat/prepared/curve_blocks.h"

#include <algorithm>
#include <vector>

#include "ngs/backend/for_each.h"
#include "ngs/math/curve_order.h"

namespace ngs {
namespace {

// Samplesort: the curve is split into parts of about equal size by a sample of the points; each part is sorted alone.
//   Frazer, McKellar, "Samplesort: a sampling approach to minimal storage tree sorting", J. ACM 17(3), 1970
constexpr std::size_t kParts = 256, kSample = 64 * kParts;
constexpr std::size_t kChunkRows = 1 << 16;

class CurveSort {
 public:
  CurveSort(const Exec& exec, std::span<const float> points)
      : exec_(exec), points_(points), size_(points.size() / 3), chunks_((size_ + kChunkRows - 1) / kChunkRows) {}

  RawColumn<std::uint32_t> order() {
    span_grid();
    find_cells();
    choose_parts();
    scatter_to_parts();
    for_each_task(exec_, kParts, [&](std::int64_t p) {
      const std::size_t begin = part_begin_[std::size_t(p)], count = part_begin_[std::size_t(p) + 1] - begin;
      sort_by_cell({&in_parts_[begin], count}, {&rows_[begin], count});
    });
    RawColumn<std::uint32_t> order(size_);
    in_chunks([&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t place = begin; place < end; ++place) order[place] = in_parts_[place].row;
    });
    return order;
  }

 private:
  /// f(chunk, first row, end row) for every chunk, in parallel.
  template <class F>
  void in_chunks(const F& f) const {
    for_each_task(exec_, std::int64_t(chunks_), [&](std::int64_t chunk) {
      const auto c = std::size_t(chunk);
      f(c, c * kChunkRows, std::min(size_, (c + 1) * kChunkRows));
    });
  }

  void span_grid() {
    std::vector<MortonGrid> of_chunk(chunks_);
    in_chunks([&](std::size_t c, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        if (is_finite(&points_[3 * i])) of_chunk[c].include(&points_[3 * i]);
    });
    for (const MortonGrid& grid : of_chunk) grid_.include(grid);
  }

  void find_cells() {
    rows_.resize(size_);
    in_chunks([&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) rows_[i] = {grid_.cell_of(&points_[3 * i]), std::uint32_t(i)};
    });
  }

  void choose_parts() {
    std::vector<std::uint64_t> sample;
    for (std::size_t i = 0; i < size_; i += size_ / kSample + 1) sample.push_back(rows_[i].cell);
    std::sort(sample.begin(), sample.end());
    for (std::size_t p = 1; p < kParts && !sample.empty(); ++p) splitter_.push_back(sample[p * sample.size() / kParts]);
  }
  std::size_t part_of(const CurvePoint& row) const {
    return std::size_t(std::upper_bound(splitter_.begin(), splitter_.end(), row.cell) - splitter_.begin());
  }

  /// Stable: rows of one part keep their order.
  void scatter_to_parts() {
    RawColumn<std::uint8_t> part(size_);
    std::vector<std::size_t> next(chunks_ * kParts, 0);  // [chunks, parts] row counts; then the place of the next row
    in_chunks([&](std::size_t c, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        part[i] = std::uint8_t(part_of(rows_[i]));
        ++next[c * kParts + part[i]];
      }
    });
    std::size_t at = 0;
    for (std::size_t p = 0; p < kParts; ++p) {
      part_begin_.push_back(at);
      for (std::size_t c = 0; c < chunks_; ++c) at += std::exchange(next[c * kParts + p], at);
    }
    part_begin_.push_back(at);
    in_parts_.resize(size_);
    in_chunks([&](std::size_t c, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) in_parts_[next[c * kParts + part[i]]++] = rows_[i];
    });
  }

  const Exec& exec_;
  std::span<const float> points_;
  std::size_t size_, chunks_;
  MortonGrid grid_;
  RawColumn<CurvePoint> rows_, in_parts_;
  std::vector<std::uint64_t> splitter_;  // [kParts - 1] first cell of each part but the first
  std::vector<std::size_t> part_begin_;  // [kParts + 1]
};

}  // namespace

RawColumn<std::uint32_t> parallel_curve_order(const Exec& exec, std::span<const float> points) {
  return CurveSort(exec, points).order();
}

}  // namespace ngs
