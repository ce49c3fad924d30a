#pragma once
// A table of which few cells are ever touched: with many objects a Gaussian is part of one or two of them.
#include <cstdint>
#include <deque>
#include <vector>

namespace ngs {

/// [rows, columns] cells, all of them Cell() until they are touched. A cell that was touched takes its size and 8
/// bytes, every row 4 bytes. Cells of a row are in the order of their columns, whatever the order in which they were
/// touched. Finding one takes as long as its row has cells.
template <class Cell>
class SparseTable {
 public:
  SparseTable() = default;
  SparseTable(std::size_t rows, std::size_t columns) : columns_(columns), first_(rows, kNone) {}

  std::size_t columns() const { return columns_; }
  std::size_t touched() const { return node_.size(); }

  /// Null where it was never touched.
  const Cell* find(std::size_t row, std::size_t column) const {
    std::uint32_t at = first_[row];
    while (at != kNone && node_[at].column < column) at = node_[at].next;
    return at != kNone && node_[at].column == column ? &node_[at].cell : nullptr;
  }
  /// Different cells may be changed by several threads at a time, while none is touched.
  Cell* find(std::size_t row, std::size_t column) {
    return const_cast<Cell*>(static_cast<const SparseTable&>(*this).find(row, column));
  }
  Cell& touch(std::size_t row, std::size_t column) {
    std::uint32_t* at = &first_[row];
    while (*at != kNone && node_[*at].column < column) at = &node_[*at].next;
    if (*at == kNone || node_[*at].column != column) {
      const auto made = std::uint32_t(node_.size());
      node_.push_back({{}, std::uint32_t(column), *at});  // a deque: `at` stays
      *at = made;
    }
    return node_[*at].cell;
  }
  /// What a cell that was never touched is to have added.
  struct First {
    std::uint32_t row, column;
    Cell cell;
  };
  /// Adds to a cell; different ones from several threads at a time. One that was never touched is put off.
  void add(std::size_t row, std::size_t column, const Cell& cell, std::vector<First>& deferred_inserts) {
    if (Cell* const known = find(row, column))
      known->add(cell);
    else
      deferred_inserts.push_back({std::uint32_t(row), std::uint32_t(column), cell});
  }
  void add(const std::vector<First>& deferred_inserts) {
    for (const First& first : deferred_inserts) touch(first.row, first.column).add(first.cell);
  }
  /// f(column, cell) of the cells of a row that were touched.
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

  std::size_t columns_ = 0;
  std::vector<std::uint32_t> first_;  // [rows] into node_
  std::deque<Node> node_;
};

}  // namespace ngs
