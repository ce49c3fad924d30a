#pragma once
// Evidence of several views, and what the others say without one of them.
#include <functional>
#include <map>
#include <memory>
#include <set>

#include "ngs/backend/for_each.h"
#include "ngs/scene/evidence.h"
#include "ngs/scene/labels/label_columns.h"

namespace ngs {

/// Keeps the weights of single views up to `cache_bytes`; those of further views are gathered anew when they are asked
/// for.
class LeaveOneOut {
 public:
  /// What view n says.
  using Gather = std::function<ViewWeights(std::size_t n)>;
  LeaveOneOut(const Exec& exec, std::int64_t gaussians, int objects, Gather gather,
              std::size_t cache_bytes = 512u << 20);

  /// Begins with what these views say, as labels and weight [N] hold it: with a float's rounding. A view's weights are
  /// gathered where they are asked for.
  void start(const std::vector<LabelColumns>& labels, const std::vector<float>& weight,
             const std::vector<std::size_t>& views);
  void add(std::size_t n);
  /// A view that was added: nothing of it is left.
  void remove(std::size_t n);

  /// [N], [N, K] of all views that were added and not removed.
  double weight(std::size_t gaussian) const { return weight_.value(gaussian); }
  double object_weight(std::size_t gaussian, std::size_t k) const {
    const ExactSum* sum = object_weight_.find(gaussian, k);
    return sum == nullptr ? 0.0 : sum->value();
  }

  /// What views say of a Gaussian.
  struct Shares {
    bool seen;           // it has weight: of all views any, of the others at least a thousandth
    const float* share;  // [K] of objects in its weight; 0 where not seen
  };
  /// f(gaussian, shares) with what all views say, of all Gaussians, from several threads.
  template <class F>
  void for_all(const F& f) const {
    constexpr std::int64_t kChunk = 1 << 14;
    for_each_task(exec_, (gaussians_ + kChunk - 1) / kChunk, [&](std::int64_t chunk) {
      std::vector<float> share(objects_);
      const auto end = std::size_t(std::min(gaussians_, (chunk + 1) * kChunk));
      for (auto i = std::size_t(chunk * kChunk); i < end; ++i) f(i, shares_of(i, share.data()));
    });
  }
  /// The same of what view n, with these weights, shows.
  template <class F>
  void for_all_in(const ViewWeights& own, const F& f) const {
    for_each_in(own, [&](std::size_t i, const double*, float* share) { f(i, shares_of(i, share)); });
  }
  /// f(gaussian, shares, weight in view n) with what the views other than n, whose weights these are, say of what it
  /// shows; of all else they say what all say.
  template <class F>
  void for_others_in(const ViewWeights& own, const F& f) const {
    for_each_in(
        own, [&](std::size_t i, const double* mine, float* share) { f(i, shares_without(i, mine, share), mine[0]); });
  }
  /// The weights of a view; null where it was not added, and takes nothing away.
  std::shared_ptr<const ViewWeights> weights_of(std::size_t n);

 private:
  template <class F>
  void for_each_in(const ViewWeights& own, const F& f) const {
    for_each_task(exec_, std::int64_t(own.parts()), [&](std::int64_t part) {
      std::vector<float> share(objects_);
      own.for_each(std::size_t(part),
                   [&](std::uint32_t gaussian, const double* mine) { f(std::size_t(gaussian), mine, share.data()); });
    });
  }
  /// Keeps them where there is room.
  void keep(std::size_t n, const std::shared_ptr<const ViewWeights>& own);
  Shares shares_of(std::size_t gaussian, float* share) const;
  Shares shares_without(std::size_t gaussian, const double* mine, float* share) const;

  const Exec exec_;
  std::int64_t gaussians_;
  std::size_t objects_;
  Gather gather_;
  std::size_t left_bytes_;
  ExactSums weight_;                                                // [N] of all views
  SparseTable<ExactSum> object_weight_;                             // [N, K]
  std::map<std::size_t, std::shared_ptr<const ViewWeights>> cache_;  // by view
  std::set<std::size_t> not_kept_;                                  // views that were added too
};

}  // namespace ngs
