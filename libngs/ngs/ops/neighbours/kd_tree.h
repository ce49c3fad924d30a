#pragma once
// A k-d tree over points in space, for exact searches.
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace ngs {

/// Splits at the median of the longer extent, down to leaves of a few points.
class KdTree {
 public:
  /// `point`: [n][3], finite; n below 2^31.
  explicit KdTree(std::span<const double> point) : point_(point.size() / 3) {
    for (std::size_t i = 0; i < point_.size(); ++i)
      point_[i] = {{point[3 * i], point[3 * i + 1], point[3 * i + 2]}, std::uint32_t(i)};
    std::size_t nodes = 1;
    for (std::size_t n = point_.size(); n > kLeaf; n = n - n / 2) nodes *= 2;
    split_.resize(nodes);
    split(1, 0, point_.size());
  }

  /// Calls result.add(squared distance, index) for points whose squared distance is below result.worst(), until none
  /// is. Squared distances are sums over x, y, z in this order; so are their bounds, which are therefore never above
  /// them.
  template <class Result>
  void search(Result& result, const double* query) const {
    search_node(result, query, {1, 0, point_.size(), {0, 0, 0}});
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

  struct Point {
    std::array<double, 3> at;
    std::uint32_t index;
  };

  void split(std::size_t node, std::size_t begin, std::size_t end) {
    if (end - begin <= kLeaf) return;
    std::array<double, 3> low = point_[begin].at, high = low;
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], point_[i].at[axis]);
        high[axis] = std::max(high[axis], point_[i].at[axis]);
      }
    Split& here = split_[node];
    std::size_t& axis = here.axis;
    for (const std::size_t other : {1, 2})
      if (high[other] - low[other] > high[axis] - low[axis]) axis = other;
    const std::size_t middle = begin + (end - begin) / 2;
    const auto first = point_.begin();
    std::nth_element(first + std::ptrdiff_t(begin), first + std::ptrdiff_t(middle), first + std::ptrdiff_t(end),
                     [axis](const Point& a, const Point& b) { return a.at[axis] < b.at[axis]; });
    here.high_begin = point_[middle].at[axis];
    here.low_end = point_[begin].at[axis];
    for (std::size_t i = begin; i < middle; ++i) here.low_end = std::max(here.low_end, point_[i].at[axis]);
    split(2 * node, begin, middle);
    split(2 * node + 1, middle, end);
  }

  template <class Result>
  void search_node(Result& result, const double* query, const Part& part) const {
    if (part.end - part.begin <= kLeaf) {
      for (std::size_t i = part.begin; i < part.end; ++i)
        if (const double distance2 =
                sum_of_squares({query[0] - point_[i].at[0], query[1] - point_[i].at[1], query[2] - point_[i].at[2]});
            distance2 < result.worst())
          result.add(distance2, point_[i].index);
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

  std::vector<Point> point_;  // in the order of the leaves
  std::vector<Split> split_;  // of node n, whose halves are nodes 2 n and 2 n + 1
};

}  // namespace ngs
