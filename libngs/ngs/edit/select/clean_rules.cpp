#include "ngs/edit/select/clean_rules.h"

#include <algorithm>
#include <cmath>

#include "ngs/edit/select/clusters.h"
#include "ngs/math/median.h"
#include "ngs/math/stable.h"
#include "ngs/math/union_find.h"
#include "ngs/ops/neighbours/knn.h"
#include "ngs/problem/cloud_rows.h"

namespace ngs {
namespace {

constexpr int kNeighbours = 8;
constexpr std::size_t kMinRows = kNeighbours + 2;
constexpr double kReach = 3;  // standard deviations

/// The standard deviations of a Gaussian, ln world, ascending.
std::array<double, 3> log_sizes(const GaussianCloud& cloud, std::size_t i) {
  std::array<double, 3> s{cloud.log_scale[3 * i], cloud.log_scale[3 * i + 1], cloud.log_scale[3 * i + 2]};
  std::sort(s.begin(), s.end());
  return s;
}

class Cleaner {
 public:
  Cleaner(const Exec& exec, const CleanOptions& options, const GaussianCloud& cloud)
      : exec_(exec), options_(options), cloud_(cloud) {
    finding_.debris.assign(std::size_t(cloud.size()), Debris::kNone);
  }

  CleanFinding run() {
    mark_single();
    if (options_.isolation > 0 && find_neighbours()) {
      mark_isolated();
      if (options_.floater_size > 0) mark_floaters();
    }
    for (const Debris d : finding_.debris) ++finding_.counts[std::size_t(d)];
    return std::move(finding_);
  }

 private:
  void mark_single() {
    const orbit::SurfacePoints points = canonical_points(cloud_);
    const orbit::Ball bulk = points.count() > 0 ? orbit::bulk_of(points) : orbit::Ball{};
    const double log_needle = std::log(options_.max_needle);  // -inf for 0
    for (std::size_t i = 0; i < finding_.debris.size(); ++i) {
      Debris& debris = finding_.debris[i];
      if (!cloud_.usable[i]) {
        debris = Debris::kUnusable;
        continue;
      }
      const auto size = log_sizes(cloud_, i);
      if (sigmoid(double(cloud_.logit_opacity[i])) < options_.min_opacity)
        debris = Debris::kTransparent;
      else if (options_.max_size > 0 && std::exp(size[2]) > options_.max_size * scale_at(i, bulk))
        debris = Debris::kOversized;
      else if (options_.max_needle > 0 && size[2] - size[1] > log_needle)
        debris = Debris::kNeedle;
    }
  }

  /// The distance from the middle of the bulk, at least the radius of the bulk.
  double scale_at(std::size_t i, const orbit::Ball& bulk) const {
    const float* p = &cloud_.position[3 * i];
    return std::max(bulk.radius, length(orbit::Vec{p[0], p[1], p[2]} - bulk.centre));
  }

  /// Finds the neighbours of the remaining Gaussians; false if there are fewer than kMinRows.
  bool find_neighbours() {
    rows_ = canonical_rows(cloud_);
    std::erase_if(rows_, [&](std::uint32_t i) { return finding_.debris[i] != Debris::kNone; });
    for (const std::size_t i : rows_)
      position_.insert(position_.end(), &cloud_.position[3 * i], &cloud_.position[3 * i] + 3);
    if (rows_.size() < kMinRows) return false;
    graph_ = nearest_others(exec_, {position_.data(), std::int64_t(rows_.size())}, kNeighbours);
    for (std::size_t q = 0; q < rows_.size(); ++q)
      spacing_.push_back(std::sqrt(double(graph_.dist2[(q + 1) * kNeighbours - 1])));
    median_spacing_ = upper_median(spacing_);
    return true;
  }

  bool is_remaining(std::size_t q) const { return finding_.debris[rows_[q]] == Debris::kNone; }
  double reach(std::size_t q) const { return kReach * std::exp(log_sizes(cloud_, rows_[q])[2]); }

  /// At least that of the median spacing, so that the surroundings of a very dense clump are no debris.
  double isolation_distance(double spacing) const { return options_.isolation * std::max(spacing, median_spacing_); }

  void mark_isolated() {
    for (std::size_t q = 0; q < rows_.size(); ++q) {
      std::vector<double> near;
      for (std::size_t k = q * kNeighbours; k < (q + 1) * kNeighbours; ++k) near.push_back(spacing_[graph_.index[k]]);
      if (spacing_[q] > isolation_distance(upper_median(std::move(near))) && spacing_[q] > reach(q))
        finding_.debris[rows_[q]] = Debris::kIsolated;
    }
  }

  /// Connects neighbours closer than the sum of their reaches, or than three times the smaller of their spacings.
  UnionFind components() const {
    UnionFind sets(rows_.size());
    for (std::size_t q = 0; q < rows_.size(); ++q)
      for (std::size_t k = q * kNeighbours; k < (q + 1) * kNeighbours; ++k) {
        const std::size_t other = graph_.index[k];
        if (!is_remaining(q) || !is_remaining(other)) continue;
        const double spacing = 3 * std::min(spacing_[q], spacing_[other]);
        if (std::sqrt(double(graph_.dist2[k])) <= std::max(spacing, reach(q) + reach(other)))
          sets.join(std::uint32_t(q), std::uint32_t(other));
      }
    return sets;
  }

  void mark_floaters() {
    UnionFind sets = components();
    std::vector<std::int64_t> size(rows_.size(), 0);
    for (std::size_t q = 0; q < rows_.size(); ++q) ++size[sets.root(std::uint32_t(q))];
    std::vector<std::uint32_t> large, small;
    for (std::size_t q = 0; q < rows_.size(); ++q) {
      if (!is_remaining(q)) continue;
      (size[sets.root(std::uint32_t(q))] > options_.floater_size ? large : small).push_back(std::uint32_t(q));
    }
    if (large.empty() || small.empty()) return;
    const KnnGraph nearest = [&] {
      const std::vector<float> points = gather_column(exec_, position_, 3, large),
                               queries = gather_column(exec_, position_, 3, small);
      return nearest_points(exec_, {points.data(), std::int64_t(large.size())},
                            {queries.data(), std::int64_t(small.size())}, 1);
    }();
    std::vector<std::uint8_t> attached(rows_.size(), 0);  // by root: some Gaussian of the component is near a large one
    for (std::size_t k = 0; k < small.size(); ++k) {
      const std::size_t q = small[k], other = large[nearest.index[k]];
      const double far = std::max(isolation_distance(spacing_[other]), reach(q) + reach(other));
      if (std::sqrt(double(nearest.dist2[k])) <= far) attached[sets.root(small[k])] = 1;
    }
    for (const std::uint32_t q : small)
      if (!attached[sets.root(q)]) finding_.debris[rows_[q]] = Debris::kFloater;
  }

  const Exec& exec_;
  const CleanOptions& options_;
  const GaussianCloud& cloud_;
  CleanFinding finding_;
  std::vector<std::uint32_t> rows_;  // remaining rows of the model
  std::vector<float> position_;      // [rows, 3]
  KnnGraph graph_;
  std::vector<double> spacing_;  // [rows] distance to neighbour kNeighbours, world
  double median_spacing_ = 0;    // median of spacing_
};

}  // namespace

CleanFinding find_debris(const Exec& exec, const CleanOptions& options, const GaussianCloud& cloud) {
  return Cleaner(exec, options, cloud).run();
}

}  // namespace ngs
