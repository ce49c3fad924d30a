#pragma once
// A numbered subset of the rows of a model. Arrays that are computed for the subset have no entries for other rows.
#include <cstdint>
#include <utility>
#include <vector>

namespace ngs {

struct RowNumbers {
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  std::vector<std::int64_t> row;      // [size] increasing
  std::vector<std::uint32_t> number;  // [N] index of the row in the subset; kNone: not in it
  std::vector<std::uint8_t> chosen;   // [N] 1: in the subset

  RowNumbers() = default;
  /// The rows with chosen[row] != 0.
  explicit RowNumbers(std::vector<std::uint8_t> chosen_rows)
      : number(chosen_rows.size(), kNone), chosen(std::move(chosen_rows)) {
    for (std::size_t i = 0; i < chosen.size(); ++i)
      if (chosen[i]) {
        number[i] = std::uint32_t(row.size());
        row.push_back(std::int64_t(i));
      }
  }
  /// `rows`: increasing, each below n.
  RowNumbers(std::vector<std::int64_t> rows, std::int64_t n)
      : row(std::move(rows)), number(std::size_t(n), kNone), chosen(std::size_t(n), 0) {
    for (std::size_t r = 0; r < row.size(); ++r) {
      number[std::size_t(row[r])] = std::uint32_t(r);
      chosen[std::size_t(row[r])] = 1;
    }
  }

  std::int64_t size() const { return std::int64_t(row.size()); }
  bool has(std::size_t i) const { return chosen[i] != 0; }
};

}  // namespace ngs
