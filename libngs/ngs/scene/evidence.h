#pragma once
// Mask evidence per Gaussian, summed over views. Additive: the evidence of a set of views is the exact sum of its
// parts, in any order and sharding. So merged shards equal a single run byte for byte.
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/math/exact_sum.h"
#include "ngs/math/sparse_table.h"

namespace ngs {

/// The evidence of a single view for the V Gaussians with W > 0.
struct ViewSums {
  int objects = 0;
  std::vector<std::uint32_t> row;  // [V] ascending
  std::vector<double> sum;         // [V, 2 + 2 K] W, pixels, then W1 <= W and pixels per object

  std::size_t size() const { return row.size(); }
  int columns() const { return 2 + 2 * objects; }
  const double* at(std::size_t v) const { return &sum[v * std::size_t(columns())]; }
  double weight(std::size_t v) const { return at(v)[0]; }
  double object_weight(std::size_t v, std::size_t k) const { return at(v)[2 + 2 * k]; }
};

/// The weights of a single view, packed to about 8 bytes per Gaussian for any number of objects, so that all views fit
/// in memory. Parts hold disjoint Gaussians and can be written and read in parallel.
class ViewWeights {
 public:
  ViewWeights(int objects, std::size_t parts) : objects_(std::size_t(objects)), part_(parts) {}

  /// Adds a Gaussian with W > 0 that no part contains yet. `sum` [2 + 2 K] as in ViewSums; the pixel counts are
  /// ignored.
  void add(std::size_t part, std::uint32_t gaussian, const double* sum);
  /// Call after the last add() to a part.
  void shrink_to_fit(std::size_t part) { part_[part].bytes.shrink_to_fit(); }

  std::size_t parts() const { return part_.size(); }
  std::size_t bytes() const;
  bool empty() const { return bytes() == 0; }
  /// f(gaussian, weight) in order of add(); weight [1 + K]: W, then W1 per object, bit-identical to the input.
  template <class F>
  void for_each(std::size_t part, const F& f) const {
    std::vector<double> weight(1 + objects_);
    std::uint32_t gaussian = 0;
    const std::uint8_t *at = part_[part].bytes.data(), *end = at + part_[part].bytes.size();
    while (at < end) {
      at = next(at, gaussian, weight.data());
      f(gaussian, static_cast<const double*>(weight.data()));
    }
  }

 private:
  struct Part {
    std::vector<std::uint8_t> bytes;
    std::uint32_t last = 0;  // Gaussian
  };
  const std::uint8_t* next(const std::uint8_t* at, std::uint32_t& gaussian, double* weight) const;

  std::size_t objects_;
  std::vector<Part> part_;
};

/// Mask evidence of one object for a Gaussian.
struct ObjectShare {
  ExactSum weight;           // W1 = Σ_views Σ_pixels w M, at most W
  std::uint64_t pixels = 0;  // pixels reached with M >= 0.5
  // Per-view signals m = W1 / W, quantised to 2^-32: their sum in these units, and the sum of their squares.
  std::uint64_t signal_sum = 0;
  ExactSum signal_square_sum;
  // Per-view contrast r = |n₊ - n₋| / (n₊ + n₋) of the unweighted counts (COB-GS), quantised to 2^-32. Stored as Σ (1 -
  // r) in these units, which is 0 for a Gaussian outside all masks of the object.
  std::uint64_t one_minus_contrast_sum = 0;

  void add(const ObjectShare& other);
  /// Adds the signal m in [0, 1] of one view. m² is stored as the exact square of the quantised m: as a double it could
  /// be smaller, and the variance of equal signals negative.
  void add_signal(double m);
  bool operator==(const ObjectShare&) const = default;
};

/// Evidence of N Gaussians and K objects. w = α T is a Gaussian's weight at a pixel, M the mask there.
struct Evidence {
  std::int64_t gaussians = 0;
  int objects = 0;
  ExactSums weight;                   // [N] W = Σ_views Σ_pixels w over known pixels
  std::vector<std::uint64_t> pixels;  // [N] known pixels reached (unweighted)
  std::vector<std::uint32_t> views;   // [N] views with W > 0
  SparseTable<ObjectShare> share;     // [N, K] sparse: most objects have no share in most Gaussians

  Evidence() = default;
  Evidence(std::int64_t n, int k);
  void add(const Evidence& other);
  /// Adds the evidence of one view for a Gaussian, a row of ViewSums. Not thread-safe.
  void add(std::size_t gaussian, const double* sum);
  using DeferredInserts = std::vector<SparseTable<ObjectShare>::Insert>;
  /// Thread-safe for different Gaussians. Afterwards pass `deferred_inserts` to share.add().
  void add(std::size_t gaussian, const double* sum, DeferredInserts& deferred_inserts);
  /// For a Gaussian without a share of any object.
  void add_background(std::size_t gaussian, double w, double count) {
    weight.add(gaussian, w);
    pixels[gaussian] += std::uint64_t(count);
    views[gaussian] += 1;
  }
  double object_weight(std::size_t gaussian, std::size_t object) const {
    const ObjectShare* known = share.find(gaussian, object);
    return known == nullptr ? 0.0 : known->weight.value();
  }
  std::uint64_t object_pixels(std::size_t gaussian, std::size_t object) const {
    const ObjectShare* known = share.find(gaussian, object);
    return known == nullptr ? 0 : known->pixels;
  }
  /// Σ r over the views, in units of 2^-32.
  std::uint64_t contrast_sum(std::size_t gaussian, std::size_t object) const {
    const ObjectShare* known = share.find(gaussian, object);
    return contrast_sum(gaussian, known == nullptr ? ObjectShare() : *known);
  }
  /// [N] W in float, as stored with the labels.
  std::vector<float> weights() const;
  std::uint64_t contrast_sum(std::size_t gaussian, const ObjectShare& of) const {
    return (std::uint64_t(views[gaussian]) << 32) - of.one_minus_contrast_sum;
  }
};

/// 4 · variance of the signal over `views`, in [0, 1]. V Σ m² - (Σ m)² is evaluated in integers, free of cancellation
/// error.
double between_views_variance(const ObjectShare& of, std::uint32_t views);

}  // namespace ngs
