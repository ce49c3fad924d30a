#include "ngs/scene/labels/label_column.h"

#include <algorithm>

#include "ngs/core/check.h"

namespace ngs {
namespace {

/// +0 only: columns preserve bits, so -0 is stored.
bool is_positive_zero(float value) { return std::bit_cast<std::uint32_t>(value) == 0; }
bool same_bits(float a, float b) { return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b); }

}  // namespace

void LabelColumn::Page::put(std::size_t row, float to) {
  std::uint64_t& word = has[row / 64];
  const std::uint64_t bit = std::uint64_t(1) << row % 64;
  const std::size_t place = before[row / 64] + std::size_t(std::popcount(word & (bit - 1)));
  if ((word & bit) != 0) {
    value[place] = to;
    return;
  }
  if (value.size() == value.capacity()) value.reserve(std::min(kPageRows, value.size() + value.size() / 4 + 8));
  value.insert(value.begin() + std::ptrdiff_t(place), to);
  word |= bit;
  for (std::size_t later = row / 64 + 1; later < kWords; ++later) ++before[later];
}

void LabelColumn::put(std::size_t row, float value) {
  std::shared_ptr<Page>& page = page_[row / kPageRows];
  if (same_bits(at(row), value)) return;
  if (!page) page = std::make_shared<Page>();
  if (page.use_count() > 1) page = std::make_shared<Page>(*page);
  page->put(row % kPageRows, value);
}

void LabelColumn::assign(std::size_t rows, float value) {
  *this = {};
  resize(rows);
  if (is_positive_zero(value)) return;
  Page full;
  for (std::size_t row = 0; row < kPageRows; ++row) full.put(row, value);
  const auto one = std::make_shared<Page>(std::move(full));
  std::ranges::fill(page_, one);
  const std::size_t last = rows % kPageRows;
  if (last == 0) return;
  page_.back() = std::make_shared<Page>();
  for (std::size_t row = 0; row < last; ++row) page_.back()->put(row, value);
}

void LabelColumn::resize(std::size_t rows) {
  if (rows < rows_ && rows % kPageRows != 0) {  // rows that are added again later must be 0
    const std::size_t first = rows / kPageRows * kPageRows;
    std::vector<float> last_page(begin() + std::ptrdiff_t(first), begin() + std::ptrdiff_t(rows));
    page_.resize(rows / kPageRows);
    rows_ = first;
    return append(last_page.data(), last_page.size());
  }
  page_.resize((rows + kPageRows - 1) / kPageRows);
  rows_ = rows;
}

void LabelColumn::push_back(float value) {
  resize(rows_ + 1);
  put(rows_ - 1, value);
}

void LabelColumn::append(const float* values, std::size_t count) {
  const std::size_t first = rows_;
  resize(rows_ + count);
  for (std::size_t i = 0; i < count; ++i) put(first + i, values[i]);
}

bool LabelColumn::same(const Page& a, const Page& b) {
  return a.has == b.has && std::ranges::equal(a.value, b.value, same_bits);
}

void LabelColumn::share(const LabelColumn& other) {
  for (std::size_t row = 0; row < rows_; row += kPageRows) share(other, row);
}

void LabelColumn::share(const LabelColumn& other, std::size_t row) {
  NGS_CHECK(rows_ == other.rows_, "columns of the same model");
  std::shared_ptr<Page>& mine = page_[row / kPageRows];
  const std::shared_ptr<Page>& others = other.page_[row / kPageRows];
  if (mine && others && mine != others && same(*mine, *others)) mine = others;
}

std::size_t LabelColumn::unshared_bytes() const {
  std::size_t bytes = page_.capacity() * sizeof page_[0];
  for (const auto& page : page_)
    if (page && page.use_count() == 1) bytes += sizeof(Page) + page->value.capacity() * sizeof(float);
  return bytes;
}

bool operator==(const LabelColumn& a, const LabelColumn& b) {
  if (a.rows_ != b.rows_) return false;
  for (std::size_t p = 0; p < a.page_.size(); ++p) {
    if (a.page_[p] == b.page_[p]) continue;
    const std::size_t end = std::min(a.rows_, (p + 1) * LabelColumn::kPageRows);
    for (std::size_t row = p * LabelColumn::kPageRows; row < end; ++row)
      if (a.at(row) != b.at(row)) return false;
  }
  return true;
}

}  // namespace ngs
