#include "ngs/io/formats/compression/codebook.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace ngs::io {
namespace {

constexpr std::size_t kBins = 4096;

/// Prefix sums over the bins, which give the cost of any run of bins in O(1).
struct Prefix {
  std::vector<double> weight, sum, square;

  explicit Prefix(std::span<const double> count, std::span<const double> mean)
      : weight(count.size() + 1), sum(count.size() + 1), square(count.size() + 1) {
    for (std::size_t i = 0; i < count.size(); ++i) {
      weight[i + 1] = weight[i] + count[i];
      sum[i + 1] = sum[i] + count[i] * mean[i];
      square[i + 1] = square[i] + count[i] * mean[i] * mean[i];
    }
  }
  /// Sum of squares of bins [from, to) about their mean.
  double cost(std::size_t from, std::size_t to) const {
    const double n = weight[to] - weight[from], s = sum[to] - sum[from];
    return n > 0 ? std::max(0.0, square[to] - square[from] - s * s / n) : 0;
  }
  double mean(std::size_t from, std::size_t to) const { return (sum[to] - sum[from]) / (weight[to] - weight[from]); }
};

/// One layer of the optimal partition: best[to] is the minimum over the start of the last run. The minimising start
/// does not decrease with `to`, so divide and conquer finds all of them in O(n log n).
class Layer {
 public:
  Layer(const Prefix& prefix, const std::vector<double>& before, std::vector<double>& best,
        std::vector<std::uint16_t>& begin)
      : prefix_(prefix), before_(before), best_(best), begin_(begin) {}

  void solve(std::size_t low, std::size_t high, std::size_t begin_low, std::size_t begin_high) {
    if (low > high) return;
    const std::size_t to = (low + high) / 2;
    double least = std::numeric_limits<double>::infinity();
    std::size_t at = begin_low;
    for (std::size_t from = begin_low; from <= std::min(begin_high, to); ++from) {
      const double cost = before_[from] + prefix_.cost(from, to);
      if (cost < least) {
        least = cost;
        at = from;
      }
    }
    best_[to] = least;
    begin_[to] = std::uint16_t(at);
    if (to > low) solve(low, to - 1, begin_low, at);
    solve(to + 1, high, at, begin_high);
  }

 private:
  const Prefix& prefix_;
  const std::vector<double>& before_;
  std::vector<double>& best_;
  std::vector<std::uint16_t>& begin_;
};

/// Pads with the last value, so that the values ascend.
Codebook codebook_of(const std::vector<double>& values) {
  Codebook codebook;
  for (std::size_t k = 0; k < kCodebookSize; ++k) codebook[k] = float(values[std::min(k, values.size() - 1)]);
  return codebook;
}

/// Non-empty bins: the number of values in each, and their mean.
struct Bins {
  std::vector<double> count, mean;
};

Bins bins_of(std::span<const float> values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double width = (double(*high) - double(*low)) / double(kBins);
  std::vector<double> count(kBins), sum(kBins);
  for (const float v : values) {
    const auto bin = std::min(kBins - 1, std::size_t((double(v) - double(*low)) / width));
    ++count[bin];
    sum[bin] += v;
  }
  Bins bins;
  for (std::size_t b = 0; b < kBins; ++b)
    if (count[b] > 0) {
      bins.count.push_back(count[b]);
      bins.mean.push_back(sum[b] / count[b]);
    }
  return bins;
}

/// The distinct values, ascending, if there are at most 256; else empty.
std::vector<double> few_different(std::span<const float> values) {
  std::vector<float> sorted;
  for (const float v : values) {
    const auto at = std::lower_bound(sorted.begin(), sorted.end(), v);
    if (at != sorted.end() && *at == v) continue;
    if (sorted.size() == kCodebookSize) return {};
    sorted.insert(at, v);
  }
  return {sorted.begin(), sorted.end()};
}

}  // namespace

Codebook fit_codebook(std::span<const float> values) {
  if (values.empty()) return {};
  if (const std::vector<double> few = few_different(values); !few.empty()) return codebook_of(few);
  const Bins bins = bins_of(values);
  const std::size_t n = bins.count.size();
  if (n <= kCodebookSize) return codebook_of(bins.mean);
  const Prefix prefix(bins.count, bins.mean);
  std::vector<double> before(n + 1, std::numeric_limits<double>::infinity()), best(n + 1);
  before[0] = 0;
  std::vector<std::vector<std::uint16_t>> begin(kCodebookSize, std::vector<std::uint16_t>(n + 1));
  for (std::size_t layer = 0; layer < kCodebookSize; ++layer) {
    Layer(prefix, before, best, begin[layer]).solve(0, n, 0, n);
    before = best;
  }
  std::vector<double> means;
  for (std::size_t layer = kCodebookSize, to = n; layer-- > 0 && to > 0;) {
    const std::size_t from = begin[layer][to];
    if (from < to) means.push_back(prefix.mean(from, to));
    to = from;
  }
  std::reverse(means.begin(), means.end());
  return codebook_of(means);
}

std::uint8_t nearest_in(const Codebook& codebook, float value) {
  const auto above = std::lower_bound(codebook.begin(), codebook.end(), value);
  if (above == codebook.begin()) return 0;
  const auto below = std::lower_bound(codebook.begin(), codebook.end(), *(above - 1));
  if (above == codebook.end() || value - *below <= *above - value) return std::uint8_t(below - codebook.begin());
  return std::uint8_t(above - codebook.begin());
}

namespace {

/// Rows order[begin .. end) of a table.
struct Group {
  std::size_t begin, end;
  double spread = 0;       // sum of squares about the mean, all columns
  std::size_t column = 0;  // of largest variance
  float middle = 0;        // mean of that column
};

class Splitter {
 public:
  Splitter(std::span<const float> table, std::size_t columns)
      : table_(table), columns_(columns), order_(table.size() / columns), sum_(columns), square_(columns) {
    std::iota(order_.begin(), order_.end(), 0u);
    groups_.push_back(measured(0, order_.size()));
    heap_.push_back(0);
  }

  void split_until(std::size_t size) {
    while (groups_.size() < size) {
      const std::size_t widest = pop();
      if (groups_[widest].spread <= 0) return;
      split(widest);
    }
  }

  RowPalette palette() {
    RowPalette palette;
    palette.label.resize(order_.size());
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      sum_up(groups_[g].begin, groups_[g].end);
      const double n = double(groups_[g].end - groups_[g].begin);
      for (std::size_t c = 0; c < columns_; ++c) palette.rows.push_back(float(sum_[c] / n));
      for (std::size_t i = groups_[g].begin; i < groups_[g].end; ++i) palette.label[order_[i]] = std::uint32_t(g);
    }
    return palette;
  }

 private:
  const float* row(std::size_t i) const { return table_.data() + std::size_t(order_[i]) * columns_; }

  void sum_up(std::size_t begin, std::size_t end) {
    std::fill(sum_.begin(), sum_.end(), 0.0);
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t c = 0; c < columns_; ++c) sum_[c] += row(i)[c];
  }

  Group measured(std::size_t begin, std::size_t end) {
    Group group{begin, end};
    sum_up(begin, end);
    const double n = double(end - begin);
    std::fill(square_.begin(), square_.end(), 0.0);
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t c = 0; c < columns_; ++c) {
        const double d = row(i)[c] - sum_[c] / n;
        square_[c] += d * d;
      }
    group.column = std::size_t(std::max_element(square_.begin(), square_.end()) - square_.begin());
    group.middle = float(sum_[group.column] / n);
    group.spread = std::accumulate(square_.begin(), square_.end(), 0.0);
    return group;
  }

  /// Orders by spread, largest first; the older of two equal ones first.
  bool is_below(std::size_t a, std::size_t b) const {
    return groups_[a].spread != groups_[b].spread ? groups_[a].spread < groups_[b].spread : a > b;
  }
  std::size_t pop() {
    std::pop_heap(heap_.begin(), heap_.end(), [&](std::size_t a, std::size_t b) { return is_below(a, b); });
    const std::size_t widest = heap_.back();
    heap_.pop_back();
    return widest;
  }
  void push(std::size_t g) {
    heap_.push_back(g);
    std::push_heap(heap_.begin(), heap_.end(), [&](std::size_t a, std::size_t b) { return is_below(a, b); });
  }

  void split(std::size_t g) {
    const Group group = groups_[g];
    const auto first = order_.begin() + std::ptrdiff_t(group.begin), last = order_.begin() + std::ptrdiff_t(group.end);
    auto middle = std::stable_partition(
        first, last, [&](std::uint32_t r) { return table_[std::size_t(r) * columns_ + group.column] <= group.middle; });
    if (middle == first || middle == last) middle = first + (last - first) / 2;  // the mean was rounded to an end
    const auto at = std::size_t(middle - order_.begin());
    groups_[g] = measured(group.begin, at);
    groups_.push_back(measured(at, group.end));
    push(g);
    push(groups_.size() - 1);
  }

  std::span<const float> table_;
  std::size_t columns_;
  std::vector<std::uint32_t> order_;
  std::vector<double> sum_, square_;
  std::vector<Group> groups_;
  std::vector<std::size_t> heap_;
};

}  // namespace

RowPalette fit_palette(std::span<const float> table, std::size_t columns, std::size_t size) {
  Splitter splitter(table, columns);
  splitter.split_until(size);
  return splitter.palette();
}

}  // namespace ngs::io
