#pragma once
// A k-d tree over points in space, for exact searches.
#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <vector>

namespace ngs {

/// Splits at the median of the longer extent, down to leaves of a few points.
class KdTree {
 public:
  /// `point`: [n][3], finite; n below 2^31. Stays alive as long as the tree.
  explicit KdTree(const std::vector<double>& point) : index_(point.size() / 3), placed_(point.size()) {
    std::iota(index_.begin(), index_.end(), 0u);
    std::size_t nodes = 1;
    for (std::size_t n = index_.size(); n > kLeaf; n = n - n / 2) nodes *= 2;
    split_.resize(nodes);
    split(point, 1, 0, index_.size());
    for (std::size_t i = 0; i < index_.size(); ++i) std::copy_n(&point[3 * index_[i]], 3, &placed_[3 * i]);
  }

  /// Calls result.add(squared distance, index) for points whose squared distance is below result.worst(), until none
  /// is. Squared distances are sums over x, y, z in this order; so are their bounds, which are therefore never above
  /// them.
  template <class Result>
  void search(Result& result, const double* query) const {
    search_node(result, query, {1, 0, index_.size(), {0, 0, 0}});
  }

 private:
  static constexpr std::size_t kLeaf = 10;
  struct Split {
    double low_end = 0, high_begin = 0;  // of the two halves
    std::size_t axis = 0;
  };
  struct Part {
    std::size_t node, begin, end;
    std::array<double, 3> outside;  // at least this far from the query along each axis
  };

  void split(const std::vector<double>& point, std::size_t node, std::size_t begin, std::size_t end) {
    if (end - begin <= kLeaf) return;
    Split& here = split_[node];
    double longest = -1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double low = point[3 * index_[begin] + axis], high = low;
      for (std::size_t i = begin; i < end; ++i) {
        low = std::min(low, point[3 * index_[i] + axis]);
        high = std::max(high, point[3 * index_[i] + axis]);
      }
      if (high - low <= longest) continue;
      longest = high - low;
      here.axis = axis;
    }
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::uint32_t i) { return point[3 * i + here.axis]; };
    const auto first = index_.begin();
    std::nth_element(first + std::ptrdiff_t(begin), first + std::ptrdiff_t(middle), first + std::ptrdiff_t(end),
                     [&](std::uint32_t a, std::uint32_t b) { return at(a) < at(b); });
    here.high_begin = at(index_[middle]);
    here.low_end = at(index_[begin]);
    for (std::size_t i = begin; i < middle; ++i) here.low_end = std::max(here.low_end, at(index_[i]));
    split(point, 2 * node, begin, middle);
    split(point, 2 * node + 1, middle, end);
  }

  template <class Result>
  void search_node(Result& result, const double* query, const Part& part) const {
    if (part.end - part.begin <= kLeaf) {
      for (std::size_t i = part.begin; i < part.end; ++i)
        if (const double distance2 = sum_of_squares(
                {query[0] - placed_[3 * i], query[1] - placed_[3 * i + 1], query[2] - placed_[3 * i + 2]});
            distance2 < result.worst())
          result.add(distance2, index_[i]);
      return;
    }
    const Split& here = split_[part.node];
    const std::size_t middle = part.begin + (part.end - part.begin) / 2;
    Part low{2 * part.node, part.begin, middle, part.outside}, high{2 * part.node + 1, middle, part.end, part.outside};
    const double above_low = query[here.axis] - here.low_end, below_high = here.high_begin - query[here.axis];
    low.outside[here.axis] = std::max(low.outside[here.axis], above_low);
    high.outside[here.axis] = std::max(high.outside[here.axis], below_high);
    const bool low_first = above_low < below_high;
    for (const Part* half : {low_first ? &low : &high, low_first ? &high : &low})
      if (sum_of_squares(half->outside) < result.worst()) search_node(result, query, *half);
  }

  static double sum_of_squares(const std::array<double, 3>& d) { return d[0] * d[0] + d[1] * d[1] + d[2] * d[2]; }

  std::vector<std::uint32_t> index_;  // of the points, in the order of the leaves
  std::vector<double> placed_;        // their coordinates
  std::vector<Split> split_;          // of node n, whose halves are nodes 2 n and 2 n + 1
};

}  // namespace ngs
