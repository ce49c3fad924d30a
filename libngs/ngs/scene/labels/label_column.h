#pragma once
// A sparse copy-on-write column of one object's labels: one float per Gaussian, most of them 0. Zeros take no memory,
// and copies share unchanged pages. A model of two million Gaussians with many objects has hundreds of such columns,
// and every stage has its own version of them.
#include <array>
#include <bit>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <memory>
#include <vector>

namespace ngs {

/// Reads like a vector<float>. Writing rows of one column is not thread-safe.
class LabelColumn {
 public:
  static constexpr std::size_t kPageRows = 1024;

  /// Proxy reference returned by a writable `column[i]`; converts to float. Assigning an equal value keeps the page
  /// shared.
  class Cell {
   public:
    Cell(LabelColumn& column, std::size_t row) : column_(column), row_(row) {}
    Cell(const Cell&) = default;
    operator float() const { return column_.at(row_); }
    Cell& operator=(float value) {
      column_.put(row_, value);
      return *this;
    }
    Cell& operator=(const Cell& other) { return *this = float(other); }
    Cell& operator+=(float value) { return *this = float(*this) + value; }
    Cell& operator-=(float value) { return *this = float(*this) - value; }

   private:
    LabelColumn& column_;
    std::size_t row_;
  };

  class const_iterator {
   public:
    using iterator_category = std::random_access_iterator_tag;
    using value_type = float;
    using difference_type = std::ptrdiff_t;
    using reference = float;
    using pointer = const float*;

    const_iterator() = default;
    const_iterator(const LabelColumn& column, std::size_t row) : column_(&column), row_(row) {}
    float operator*() const { return column_->at(row_); }
    float operator[](difference_type by) const { return *(*this + by); }
    const_iterator& operator+=(difference_type by) {
      row_ += std::size_t(by);
      return *this;
    }
    const_iterator& operator-=(difference_type by) { return *this += -by; }
    const_iterator& operator++() { return *this += 1; }
    const_iterator& operator--() { return *this += -1; }
    const_iterator operator++(int) {
      const const_iterator before = *this;
      ++*this;
      return before;
    }
    const_iterator operator--(int) {
      const const_iterator before = *this;
      --*this;
      return before;
    }
    friend const_iterator operator+(const_iterator it, difference_type by) { return it += by; }
    friend const_iterator operator+(difference_type by, const_iterator it) { return it += by; }
    friend const_iterator operator-(const_iterator it, difference_type by) { return it -= by; }
    friend difference_type operator-(const const_iterator& a, const const_iterator& b) {
      return difference_type(a.row_) - difference_type(b.row_);
    }
    friend bool operator==(const const_iterator& a, const const_iterator& b) { return a.row_ == b.row_; }
    friend auto operator<=>(const const_iterator& a, const const_iterator& b) { return a.row_ <=> b.row_; }

   private:
    const LabelColumn* column_ = nullptr;
    std::size_t row_ = 0;
  };

  LabelColumn() = default;
  LabelColumn(std::size_t rows, float value) { assign(rows, value); }
  LabelColumn(const std::vector<float>& values) { append(values.data(), values.size()); }
  LabelColumn(std::initializer_list<float> values) { append(values.begin(), values.size()); }

  std::size_t size() const { return rows_; }
  bool empty() const { return rows_ == 0; }
  float operator[](std::size_t row) const { return at(row); }
  Cell operator[](std::size_t row) { return {*this, row}; }
  const_iterator begin() const { return {*this, 0}; }
  const_iterator end() const { return {*this, rows_}; }
  float back() const { return at(rows_ - 1); }
  std::vector<float> values() const { return {begin(), end()}; }

  void assign(std::size_t rows, float value);
  /// New rows are 0.
  void resize(std::size_t rows);
  void push_back(float value);
  void clear() { *this = {}; }

  /// Shares pages that are bit-identical to those of `other`.
  void share(const LabelColumn& other);
  /// The same for the page that holds `row`.
  void share(const LabelColumn& other, std::size_t row);
  /// Memory of pages that are not shared, bytes.
  std::size_t unshared_bytes() const;

  /// Compares values, like vectors.
  friend bool operator==(const LabelColumn& a, const LabelColumn& b);

 private:
  /// The non-zero values in row order, and a bit mask of their rows.
  struct Page {
    static constexpr std::size_t kWords = kPageRows / 64;
    std::array<std::uint64_t, kWords> has{};
    std::array<std::uint16_t, kWords> before{};  // values in earlier words
    std::vector<float> value;

    float at(std::size_t row) const {
      const std::uint64_t word = has[row / 64], bit = std::uint64_t(1) << row % 64;
      return word & bit ? value[before[row / 64] + std::size_t(std::popcount(word & (bit - 1)))] : 0.f;
    }
    void put(std::size_t row, float to);
  };

  float at(std::size_t row) const {
    const Page* page = page_[row / kPageRows].get();
    return page == nullptr ? 0.f : page->at(row % kPageRows);
  }
  void put(std::size_t row, float value);
  void append(const float* values, std::size_t count);
  static bool same(const Page& a, const Page& b);

  std::size_t rows_ = 0;
  std::vector<std::shared_ptr<Page>> page_;  // null: all 0
};

struct LabelColumns {
  LabelColumn label;     // [N] final label in [0, 1]; 1 = object
  LabelColumn prob;      // [N] f = Σ αTM / Σ αT (closed form) or the optimised sigmoid
  LabelColumn variance;  // [N] normalised mask variance in [0, 1]                         Eq. (3)
  LabelColumn views;     // [N] number of views with evidence; 0 = never seen
  LabelColumn boundary;  // [N] 1 = member of the boundary set
};

inline constexpr LabelColumn LabelColumns::*kLabelColumns[] = {
    &LabelColumns::label, &LabelColumns::prob, &LabelColumns::variance, &LabelColumns::views, &LabelColumns::boundary};

}  // namespace ngs
