#include "ngs/ops/neighbours/knn.h"

#include <flann/algorithms/kdtree_single_index.h>

#include <algorithm>
#include <cmath>
#include <flann/flann.hpp>
#include <limits>

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/optim/resident.h"

namespace ngs {
namespace {

using Distance = flann::L2_Simple<double>;
using Tree = flann::KDTreeSingleIndex<Distance>;

// FLANN's bound of a subtree is a rounded sum; this pruning slack keeps the search exact.
constexpr float kPruningSlack = 1e-6f;
constexpr std::int64_t kQueriesPerTask = 256;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Neighbour {
  double dist2;
  std::size_t index;
  bool operator<(const Neighbour& o) const { return dist2 < o.dist2 || (dist2 == o.dist2 && index < o.index); }
};

/// The K smallest (dist2, index). Of equal distances, FLANN's own result sets keep the one that the tree visits first.
/// This one admits ties (worstDist is just above the K-th) and orders them by index.
class OrderedResult : public flann::ResultSet<double> {
 public:
  /// `bound`: at least the K-th squared distance.
  OrderedResult(int capacity, std::size_t excluded, double bound)
      : capacity_(capacity), excluded_(excluded), admitted_(bound) {}
  bool full() const override { return count_ == capacity_; }
  double worstDist() const override { return admitted_; }
  void addPoint(double dist2, std::size_t index) override {
    const Neighbour candidate{dist2, index};
    if (index == excluded_ || (full() && !(candidate < best_[count_ - 1]))) return;
    int slot = full() ? count_ - 1 : count_++;
    for (; slot > 0 && candidate < best_[slot - 1]; --slot) best_[slot] = best_[slot - 1];
    best_[slot] = candidate;
    if (full()) admitted_ = std::nextafter(best_[count_ - 1].dist2, kInfinity);
  }
  const Neighbour& operator[](int slot) const { return best_[slot]; }

 private:
  int capacity_, count_ = 0;
  std::size_t excluded_;
  double admitted_;
  Neighbour best_[kMaxNeighbours];
};

/// Whether a point lies within a distance; the first one found ends the search.
class AnyResult : public flann::ResultSet<double> {
 public:
  explicit AnyResult(double most_dist2) : admitted_(std::nextafter(most_dist2, kInfinity)) {}
  bool full() const override { return found_; }
  double worstDist() const override { return admitted_; }
  void addPoint(double dist2, std::size_t) override {
    if (!(dist2 < admitted_)) return;
    found_ = true;
    admitted_ = -1;  // no distance is less: stops the search
  }
  bool found() const { return found_; }

 private:
  double admitted_;
  bool found_ = false;
};

constexpr std::size_t kNoExclusion = std::numeric_limits<std::size_t>::max();

/// Upper bound of a query's K-th squared distance, from that of another query, by the triangle inequality.
double bound_from_other(const double* query, const double* other, double dist2_of_other) {
  double step2 = 0;
  for (int a = 0; a < 3; ++a) step2 += (query[a] - other[a]) * (query[a] - other[a]);
  const double reach = std::sqrt(dist2_of_other) + std::sqrt(step2);
  return reach * reach * (1 + double(kPruningSlack)) + std::numeric_limits<double>::min();
}

void require_finite(const float* row, const char* what) {
  NGS_CHECK(std::isfinite(row[0]) && std::isfinite(row[1]) && std::isfinite(row[2]),
            std::string(what) + " must be finite");
}

std::vector<double> to_double(Rows<const float, 3> rows, const char* what) {
  for (std::int64_t i = 0; i < rows.n; ++i) require_finite(rows.row(i), what);
  return {rows.data, rows.data + rows.n * 3};
}

void require_countable(Rows<const float, 3> points) {
  NGS_CHECK(points.n <= std::numeric_limits<std::int32_t>::max(), "the search tree counts points in 32 bits");
}

/// search(tree, begin, end) for chunks of the queries; `tree`: FLANN's over the points (at least one).
template <class Search>
void for_each_chunk(const Exec& exec, std::vector<double>& point, std::int64_t queries, const Search& search) {
  Tree tree(flann::Matrix<double>(point.data(), point.size() / 3, 3), flann::KDTreeSingleIndexParams());
  tree.buildIndex();
  for_each_task(exec, (queries + kQueriesPerTask - 1) / kQueriesPerTask, [&](std::int64_t task) {
    search(tree, task * kQueriesPerTask, std::min(queries, (task + 1) * kQueriesPerTask));
  });
}

/// Bounding box of points.
class PointBox {
 public:
  explicit PointBox(const std::vector<double>& point) {
    for (std::size_t i = 0; i < point.size(); ++i) {
      lo_[i % 3] = std::min(lo_[i % 3], point[i]);
      hi_[i % 3] = std::max(hi_[i % 3], point[i]);
    }
  }
  /// Squared distance to the box: a lower bound of that to any point, also as FLANN rounds it, because differences,
  /// squares and sums are monotonic.
  double dist2(const double* query) const {
    double sum = 0;
    for (int a = 0; a < 3; ++a) {
      const double outside = std::max({lo_[a] - query[a], query[a] - hi_[a], 0.0});
      sum += outside * outside;
    }
    return sum;
  }

 private:
  double lo_[3] = {kInfinity, kInfinity, kInfinity}, hi_[3] = {-kInfinity, -kInfinity, -kInfinity};
};

flann::SearchParams exact_search() { return {flann::FLANN_CHECKS_UNLIMITED, -kPruningSlack}; }

struct Search {
  Rows<const float, 3> points, queries;
  int neighbours;
  bool exclude_self;
};

/// Fills a graph and its transpose.
void run(const Exec& exec, const Search& search, const GraphResult& out) {
  const auto& [points, queries, neighbours, self] = search;
  const bool exclude_self = self;  // clang 14 captures no structured binding
  NGS_CHECK(neighbours >= 1 && neighbours <= kMaxNeighbours, "neighbours must be in [1, kMaxNeighbours]");
  require_countable(points);
  KnnGraph& graph = out.graph;
  auto& memory = out.memory;
  graph.points = points.n;
  graph.neighbours = std::max(0, int(std::min<std::int64_t>(neighbours, points.n - (exclude_self ? 1 : 0))));
  if (queries.n == 0) graph.neighbours = 0;
  const std::size_t edges = std::size_t(queries.n) * std::size_t(graph.neighbours);
  memory.shape(graph.index, edges);
  memory.shape(graph.dist2, edges);
  memory.shape(graph.edge, edges);
  memory.shape(graph.row_begin, std::size_t(points.n) + 1);
  if (edges == 0) return fill_zero(exec, graph.row_begin);
  std::vector<double> point = to_double(points, "points");
  const std::vector<double> query = to_double(queries, "queries");
  if (exec.device_ops) return exec.device_ops->field.nearest(points, queries, exclude_self, graph);

  const int k = graph.neighbours;
  const auto chunk = [&](const Tree& tree, std::int64_t begin, std::int64_t end) {
    double last_dist2 = kInfinity;  // K-th distance of the previous query, which is often near
    for (std::int64_t i = begin; i < end; ++i) {
      const double* at_query = query.data() + 3 * i;
      const double bound = std::isfinite(last_dist2) ? bound_from_other(at_query, at_query - 3, last_dist2) : kInfinity;
      OrderedResult result(k, exclude_self ? std::size_t(i) : kNoExclusion, bound);
      tree.findNeighbors(result, at_query, exact_search());
      if (!exclude_self) last_dist2 = result[k - 1].dist2;
      for (int slot = 0; slot < k; ++slot) {
        const std::size_t at = std::size_t(i) * std::size_t(k) + std::size_t(slot);
        graph.index[at] = std::uint32_t(result[slot].index);
        graph.dist2[at] = float(result[slot].dist2);
      }
    }
  };
  for_each_chunk(exec, point, queries.n, chunk);
  build_transpose(graph);
}

KnnGraph found(const Exec& exec, const Search& search) {
  KnnGraph graph;
  ResidentResults on_host({});
  run(exec, search, {graph, on_host});
  return graph;
}

}  // namespace

KnnGraph nearest_points(const Exec& exec, Rows<const float, 3> points, Rows<const float, 3> queries, int neighbours) {
  return found(exec, {points, queries, neighbours, false});
}

void nearest_points(const Exec& exec, Rows<const float, 3> points, Rows<const float, 3> queries, int neighbours,
                    const GraphResult& out) {
  run(exec, {points, queries, neighbours, false}, out);
}

KnnGraph nearest_others(const Exec& exec, Rows<const float, 3> points, int neighbours) {
  return found(exec, {points, points, neighbours, true});
}

std::vector<std::uint8_t> any_within(const Exec& exec, Rows<const float, 3> points, Rows<const float, 3> queries,
                                     double radius, const std::vector<std::uint8_t>& active) {
  NGS_CHECK(radius >= 0, "radius must not be negative");
  NGS_CHECK(active.empty() || std::int64_t(active.size()) == queries.n, "one flag per query");
  require_countable(points);
  std::vector<std::uint8_t> found(std::size_t(queries.n), 0);
  if (points.n == 0 || queries.n == 0) return found;
  std::vector<double> point = to_double(points, "points");
  const PointBox box(point);
  for_each_chunk(exec, point, queries.n, [&](const Tree& tree, std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      if (!active.empty() && !active[std::size_t(i)]) continue;
      const float* row = queries.row(i);
      require_finite(row, "queries");
      const double query[3] = {double(row[0]), double(row[1]), double(row[2])};
      if (box.dist2(query) > radius * radius) continue;
      AnyResult result(radius * radius);
      tree.findNeighbors(result, query, exact_search());
      found[std::size_t(i)] = result.found();
    }
  });
  return found;
}

void build_transpose(KnnGraph& graph) {
  // A counting sort by point: stable, so edges ascend within a row.
  graph.row_begin.assign(std::size_t(graph.points) + 1, 0);
  for (const std::uint32_t j : graph.index) ++graph.row_begin[j + 1];
  for (std::size_t j = 1; j < graph.row_begin.size(); ++j) graph.row_begin[j] += graph.row_begin[j - 1];
  graph.edge.resize(graph.index.size());
  std::vector<std::int64_t> next(graph.row_begin.begin(), graph.row_begin.end() - 1);
  for (std::size_t e = 0; e < graph.index.size(); ++e)
    graph.edge[std::size_t(next[graph.index[e]]++)] = std::int64_t(e);
}

double mean_spacing(const KnnGraph& graph) {
  double sum = 0;
  for (const float d2 : graph.dist2) sum += std::sqrt(double(d2));
  return graph.dist2.empty() ? 0 : sum / double(graph.dist2.size());
}

}  // namespace ngs
