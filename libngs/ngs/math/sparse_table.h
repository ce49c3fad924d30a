#pragma once
// A sparse table: with many objects, a Gaussian belongs to only one or two of them.
#include <cstdint>
#include <deque>
#include <vector>

namespace ngs {

/// Cells of some rows and any number of columns, all of them Cell() until touched. A touched cell takes its size plus 8
/// bytes, every row 4 bytes. The touched cells of a row are sorted by column, in whatever order they were touched.
/// Finding one takes time linear in their number.
template <class Cell>
class SparseTable {
 public:
  SparseTable() = default;
  explicit SparseTable(std::size_t rows) : first_(rows, kNone) {}

  /// Null if the cell was never touched.
  const Cell* find(std::size_t row, std::size_t column) const {
    std::uint32_t at = first_[row];
    while (at != kNone && node_[at].column < column) at = node_[at].next;
    return at != kNone && node_[at].column == column ? &node_[at].cell : nullptr;
  }
  /// Several threads may change different cells at a time, but not while one calls touch().
  Cell* find(std::size_t row, std::size_t column) {
    return const_cast<Cell*>(static_cast<const SparseTable&>(*this).find(row, column));
  }
  Cell& touch(std::size_t row, std::size_t column) {
    std::uint32_t* at = &first_[row];
    while (*at != kNone && node_[*at].column < column) at = &node_[*at].next;
    if (*at == kNone || node_[*at].column != column) {
      const auto made = std::uint32_t(node_.size());
      node_.push_back({{}, std::uint32_t(column), *at});  // a deque: `at` stays valid
      *at = made;
    }
    return node_[*at].cell;
  }
  /// A value to add to a cell that was not touched yet.
  struct Insert {
    std::uint32_t row, column;
    Cell cell;
  };
  /// Adds to a cell; several threads may add to different cells at a time. Values for untouched cells
  /// go to `deferred_inserts`.
  void add(std::size_t row, std::size_t column, const Cell& cell, std::vector<Insert>& deferred_inserts) {
    if (Cell* const known = find(row, column))
      known->add(cell);
    else
      deferred_inserts.push_back({std::uint32_t(row), std::uint32_t(column), cell});
  }
  /// Applies deferred inserts. Not thread-safe.
  void add(const std::vector<Insert>& deferred_inserts) {
    for (const Insert& insert : deferred_inserts) touch(insert.row, insert.column).add(insert.cell);
  }
  /// Calls f(column, cell) for the touched cells of a row.
  template <class F>
  void for_each_in(std::size_t row, const F& f) const {
    for (std::uint32_t at = first_[row]; at != kNone; at = node_[at].next) f(node_[at].column, node_[at].cell);
  }

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;
  struct Node {
    Cell cell;
    std::uint32_t column, next;
  };

  std::vector<std::uint32_t> first_;  // [rows] into node_
  std::deque<Node> node_;
};

}  // namespace ngs
