#pragma once
// The weights of several views: their sums, with all views or without one, and a cache of single views.
#include <functional>
#include <map>
#include <memory>
#include <set>

#include "ngs/backend/for_each.h"
#include "ngs/scene/evidence.h"
#include "ngs/scene/labels/label_column.h"

namespace ngs {

/// Caches the weights of single views up to `cache_bytes`; weights of further views are gathered again.
class LeaveOneOut {
 public:
  using Gather = std::function<PackedSums(std::size_t n)>;
  LeaveOneOut(const Exec& exec, std::int64_t gaussians, int objects, Gather gather,
              std::size_t cache_bytes = 512u << 20);

  /// Starts with the sums over `views`, taken from labels and weight [N], which are rounded to float. The weights of
  /// one view are gathered when they are needed.
  void start(const std::vector<LabelColumns>& labels, const std::vector<float>& weight,
             const std::vector<std::size_t>& views);
  void add(std::size_t n);
  /// Subtracts a view that was added; the sums are then exactly those without it.
  void remove(std::size_t n);

  /// Over all views that were added and not removed.
  const WeightSums<>& sums() const { return sums_; }

  /// Fractions of a Gaussian's weight that objects cover.
  struct Shares {
    bool seen;           // the Gaussian has weight; without one view: more than 1/1000 of the weight in all views
    const float* share;  // [K], 0 where not seen
  };
  /// Calls f(gaussian, shares over all views) for all Gaussians, from several threads.
  template <class F>
  void for_all(const F& f) const {
    constexpr std::int64_t kChunk = 1 << 14;
    for_each_task(exec_, (sums_.gaussians + kChunk - 1) / kChunk, [&](std::int64_t chunk) {
      std::vector<float> share(std::size_t(sums_.objects));
      const auto end = std::size_t(std::min(sums_.gaussians, (chunk + 1) * kChunk));
      for (auto i = std::size_t(chunk * kChunk); i < end; ++i) f(i, Shares{sums_.probs(i, share.data()), share.data()});
    });
  }
  /// The same for the Gaussians visible in view n only; `own`: the weights of view n.
  template <class F>
  void for_all_in(const PackedSums& own, const F& f) const {
    for_each_in(own, [&](std::size_t i, const double*, float* share) { f(i, Shares{sums_.probs(i, share), share}); });
  }
  /// Calls f(gaussian, shares over the views other than n, weight in view n) for the Gaussians visible in view n.
  /// `own`: the weights of view n. For all other Gaussians the shares are those over all views.
  template <class F>
  void for_others_in(const PackedSums& own, const F& f) const {
    for_each_in(own, [&](std::size_t i, const double* mine, float* share) {
      f(i, Shares{sums_.probs_without(mine, i, share), share}, mine[0]);
    });
  }
  /// The weights of a view; null if the view was not added.
  std::shared_ptr<const PackedSums> weights_of(std::size_t n);

 private:
  template <class F>
  void for_each_in(const PackedSums& own, const F& f) const {
    for_each_task(exec_, std::int64_t(own.parts()), [&](std::int64_t part) {
      std::vector<float> share(std::size_t(sums_.objects));
      own.for_each(std::size_t(part),
                   [&](std::uint32_t gaussian, const double* mine) { f(std::size_t(gaussian), mine, share.data()); });
    });
  }
  /// Caches the weights if they fit into the bytes left.
  void keep(std::size_t n, const std::shared_ptr<const PackedSums>& own);

  const Exec exec_;
  Gather gather_;
  std::size_t left_bytes_;
  WeightSums<> sums_;
  std::map<std::size_t, std::shared_ptr<const PackedSums>> cache_;  // by view
  std::set<std::size_t> uncached_;                                  // added views whose weights are not cached
};

}  // namespace ngs
