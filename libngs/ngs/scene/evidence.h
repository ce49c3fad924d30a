#pragma once
// Sums per Gaussian over views. w = α T is a Gaussian's rendering weight at a pixel, M the mask there. Sums are exact,
// so order and sharding do not change a bit: merged shards equal a single run. remove() leaves no rounding error, which
// would give a Gaussian without weight an arbitrary share.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "ngs/math/exact_sum.h"
#include "ngs/math/sparse_table.h"
#include "ngs/scene/labels/boundary_rule.h"
#include "ngs/scene/view_sums.h"

namespace ngs {

/// Eq. (3): the label of a share f = W1 / W, and whether a Gaussian of this normalised variance is boundary.
inline bool is_object(const BoundaryRule& rule, double prob) { return prob > rule.label_threshold; }
inline bool is_boundary(const BoundaryRule& rule, double variance) { return variance > rule.tau; }

/// The weight of one object in a Gaussian.
struct ObjectWeight {
  ExactSum weight;  // W1 = Σ_views Σ_pixels w M, at most W

  NGS_HD void add(const ObjectWeight& other) { weight.add(other.weight); }
  bool operator==(const ObjectWeight&) const = default;
};

/// W and W1 of N Gaussians and K objects. Sums: ObjectWeight, or a struct derived from it with further sums. Adding or
/// removing a view touches only its rows.
template <class Sums = ObjectWeight>
struct WeightSums {
  std::int64_t gaussians = 0;
  int objects = 0;
  ExactSums weight;                  // [N] W = Σ_views Σ_pixels w over known pixels
  SparseTable<Sums> object_weights;  // [N, K] W1; sparse: most objects have no weight in most Gaussians
  using DeferredInserts = std::vector<typename SparseTable<Sums>::Insert>;

  WeightSums() = default;
  WeightSums(std::int64_t n, int k) : gaussians(n), objects(k), object_weights(std::size_t(n)) {
    weight.resize(std::size_t(n));
  }

  void add(const ViewSums& view) {
    for (std::size_t v = 0; v < view.size(); ++v) {
      weight.add(view.row[v], view.weight(v));
      for (int k = 0; k < view.objects; ++k)
        add_object(view.row[v], std::size_t(k), view.object_weight(v, std::size_t(k)));
    }
  }
  /// `view`: one that was added.
  void remove(const ViewSums& view) {
    for (std::size_t v = 0; v < view.size(); ++v) {
      weight.subtract(view.row[v], view.weight(v));
      for (int k = 0; k < view.objects; ++k)
        remove_object(view.row[v], std::size_t(k), view.object_weight(v, std::size_t(k)));
    }
  }
  void add_object(std::size_t gaussian, std::size_t k, double w1) {
    if (w1 != 0) object_weights.touch(gaussian, k).weight.add(w1);
  }
  void remove_object(std::size_t gaussian, std::size_t k, double w1) {
    if (Sums* const known = w1 != 0 ? object_weights.find(gaussian, k) : nullptr)
      known->weight.subtract(ExactSum::of(w1));
  }

  double object_weight(std::size_t gaussian, std::size_t k) const {
    const Sums* known = object_weights.find(gaussian, k);
    return known == nullptr ? 0.0 : known->weight.value();
  }
  /// The share f = W1 / W, in [0, 1]; 0 for a Gaussian that is visible in no view.
  double prob(std::size_t gaussian, std::size_t k) const {
    const Sums* known = object_weights.find(gaussian, k);
    return known == nullptr ? 0.0 : prob(gaussian, *known);
  }
  double prob(std::size_t gaussian, const Sums& of) const {
    const double all = weight.value(gaussian);
    return all > 0 ? of.weight.value() / all : 0.0;
  }
  /// f of all objects. Writes [K] floats to `probs`; returns whether the Gaussian is visible.
  bool probs(std::size_t gaussian, float* probs) const {
    std::fill_n(probs, objects, 0.f);
    object_weights.for_each_in(gaussian, [&](std::size_t k, const Sums& of) { probs[k] = float(prob(gaussian, of)); });
    return weight.value(gaussian) > 0;
  }
  /// The same without one view, whose weights in the Gaussian are `view` [1 + K]. Visible: more than 1/1000 of the
  /// Gaussian's weight remains.
  bool probs_without(const double* view, std::size_t gaussian, float* probs) const {
    constexpr double kMinRest = 1e-3;
    const double all = weight.value(gaussian), others = all - view[0];
    std::fill_n(probs, objects, 0.f);
    if (!(others > kMinRest * all)) return false;
    object_weights.for_each_in(gaussian, [&](std::size_t k, const Sums& of) {
      probs[k] = float(std::max(0.0, of.weight.value() - view[1 + k]) / others);
    });
    return true;
  }
  /// The object with the largest weight, if it exceeds the background's weight; otherwise -1.
  int heaviest_object(std::size_t gaussian) const {
    double background = weight.value(gaussian), best_weight = 0;
    int best = -1;
    object_weights.for_each_in(gaussian, [&](std::size_t k, const Sums& of) {
      const double w = of.weight.value();
      background -= w;
      if (w > best_weight) {
        best = int(k);
        best_weight = w;
      }
    });
    return best_weight > background ? best : -1;
  }
};

/// Further sums of an object, for the criteria of variance.
struct ObjectSums : ObjectWeight {
  std::uint64_t pixels = 0;  // pixels reached with M >= 0.5
  // Per-view signals m = W1 / W, quantised to 2^-32: their sum in these units, and the sum of their squares.
  std::uint64_t signal_sum = 0;
  ExactSum signal_square_sum;
  // Per-view contrast r = |n₊ - n₋| / (n₊ + n₋) of the unweighted counts (COB-GS), quantised to 2^-32. Stored as Σ (1 -
  // r) in these units, which is 0 for a Gaussian outside all masks of the object.
  std::uint64_t one_minus_contrast_sum = 0;

  /// The sums of one view: W > 0 and n, W1 <= W and n1 of the object.
  NGS_HD static ObjectSums of_view(double w, double count, double object_w, double object_count) {
    ObjectSums of;
    of.weight = ExactSum::of(object_w);
    of.pixels = std::uint64_t(object_count);
    of.add_signal(object_w / w);
    const double difference = 2 * object_count - count;
    of.one_minus_contrast_sum = quantised(1) - quantised((difference < 0 ? -difference : difference) / count);
    return of;
  }
  NGS_HD void add(const ObjectSums& other) {
    ObjectWeight::add(other);
    pixels += other.pixels;
    signal_sum += other.signal_sum;
    signal_square_sum.add(other.signal_square_sum);
    one_minus_contrast_sum += other.one_minus_contrast_sum;
  }
  /// Adds the signal m in [0, 1] of one view. m² is stored as the exact square of the quantised m: as a double it could
  /// be smaller, and the variance of equal signals negative.
  NGS_HD void add_signal(double m) {
    const std::uint64_t units = quantised(m);  // at most 2^32
    signal_sum += units;
    signal_square_sum.add({units >> 32, units * units});
  }
  bool operator==(const ObjectSums&) const = default;

 private:
  NGS_HD static std::uint64_t quantised(double unit) { return std::uint64_t(std::llround(unit * 0x1p32)); }
};

/// Everything that files of evidence contain: the weights with counts of pixels and views, and the signals per view.
struct Evidence : WeightSums<ObjectSums> {
  std::vector<std::uint64_t> pixels;  // [N] known pixels reached (unweighted)
  std::vector<std::uint32_t> views;   // [N] views with W > 0

  Evidence() = default;
  Evidence(std::int64_t n, int k) : WeightSums(n, k), pixels(std::size_t(n)), views(std::size_t(n)) {}
  void add(const Evidence& other);
  /// Adds one view, with its pixel counts.
  void add(const ViewSums& view);
  /// Adds one view for one Gaussian, a row of ViewSums. Not thread-safe.
  void add(std::size_t gaussian, const double* sum);
  /// Thread-safe for different Gaussians. Afterwards pass `deferred_inserts` to object_weights.add().
  void add(std::size_t gaussian, const double* sum, DeferredInserts& deferred_inserts);
  /// For a Gaussian without a weight of any object.
  void add_background(std::size_t gaussian, double w, double count) {
    weight.add(gaussian, w);
    pixels[gaussian] += std::uint64_t(count);
    views[gaussian] += 1;
  }
  void remove(const ViewSums& view) = delete;  // signals cannot be removed
  /// Σ r over the views, in units of 2^-32.
  std::uint64_t contrast_sum(std::size_t gaussian, std::size_t object) const {
    const ObjectSums* known = object_weights.find(gaussian, object);
    return contrast_sum(gaussian, known == nullptr ? ObjectSums() : *known);
  }
  std::uint64_t contrast_sum(std::size_t gaussian, const ObjectSums& of) const {
    return (std::uint64_t(views[gaussian]) << 32) - of.one_minus_contrast_sum;
  }
  /// [N] W in float, as stored with the labels.
  std::vector<float> weights() const;
};

/// 4 · variance of the signal over `views`, in [0, 1]. V Σ m² - (Σ m)² is evaluated in integers, free of cancellation
/// error.
double between_views_variance(const ObjectSums& of, std::uint32_t views);

}  // namespace ngs
