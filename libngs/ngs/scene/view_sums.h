#pragma once
// Rendering weights of one view, summed per Gaussian over the pixels of its masks: m_ij before Eq. (3), paper.md §5.2.
#include <cstddef>
#include <cstdint>
#include <vector>

namespace ngs {

/// The sums of one view for V of its Gaussians. The sums over other sets of pixels have the same form: over a stroke,
/// or over the pixels where a Gaussian is in front of a surface.
struct ViewSums {
  int objects = 0;
  bool has_pixels = true;          // each weight is followed by the number of its pixels
  std::vector<std::uint32_t> row;  // [V] unique; ascending unless the function that returns them states otherwise
  std::vector<double> sum;         // [V, columns()] W, then W1 <= W per object

  std::size_t size() const { return row.size(); }
  std::size_t stride() const { return has_pixels ? 2 : 1; }
  std::size_t columns() const { return stride() * (1 + std::size_t(objects)); }
  const double* at(std::size_t v) const { return &sum[v * columns()]; }
  double weight(std::size_t v) const { return at(v)[0]; }
  double object_weight(std::size_t v, std::size_t k) const { return at(v)[stride() * (1 + k)]; }
  void add(std::uint32_t gaussian, const double* sums) {
    row.push_back(gaussian);
    sum.insert(sum.end(), sums, sums + columns());
  }

  /// The rows with W > 0, and with W1 > 0 of object k: that weight alone, as W.
  ViewSums weights() const { return positive(0); }
  ViewSums weights_inside(std::size_t k) const { return positive(stride() * (1 + k)); }

 private:
  ViewSums positive(std::size_t column) const;
};

/// The weights of ViewSums, packed to about 8 bytes per Gaussian for any number of objects, so that all views fit in
/// memory. Parts hold disjoint Gaussians and can be written and read in parallel.
class PackedSums {
 public:
  PackedSums(int objects, std::size_t parts) : objects_(std::size_t(objects)), part_(parts) {}

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

}  // namespace ngs
