#pragma once
// What of a view lies in front of a given surface, and how much of each Gaussian does.   PAPER.md §5.8
//
// A contribution is in front of pixel p where its Gaussian is a candidate and its camera z is below limit(p);
// limit 0: no surface at this pixel, nothing is in front. Weights w = α T are those of rendering the whole model.
#include <memory>

#include "ngs/math/row_numbers.h"
#include "ngs/ops/splat/splat.h"

namespace ngs {

using Candidates = std::vector<std::uint8_t>;  // [N]

/// Σ w over the view's pixels where a Gaussian is in front, and over the marked of these, of those where it is not 0.
struct FrontSums {
  std::vector<std::uint32_t> row;     // index into the cloud, each once
  std::vector<double> front, marked;  // [rows]
};

/// The candidates, and a row of values for each.
struct RowValues {
  const RowNumbers& of;
  Matrix<const float> value;  // [of, C]
};

/// A surface in one view of a model, projected once for several looks at what is before it. What lies behind all of a
/// tile's surface is left out.
class FrontView {
 public:
  /// `limit` [H, W, 1] camera z, world; it must outlive the view.
  FrontView(const Exec& exec, const GaussianCloud& cloud, const ImageF& limit, const Camera& camera,
            const SplatOptions& options);
  ~FrontView();
  FrontView(const FrontView&) = delete;
  FrontView& operator=(const FrontView&) = delete;

  /// [H, W, C + 1]: Σ w value and, last, Σ w, over the contributions in front.
  ImageF layer(const RowValues& values) const;
  /// [H, W, 1]: Σ w alone.
  ImageF layer(const Candidates& candidate) const;
  /// `marked` [H·W].
  FrontSums sums(const Candidates& candidate, const std::vector<std::uint8_t>& marked) const;

 private:
  struct State;
  ImageF layer(const Candidates& candidate, const std::uint32_t* number, Matrix<const float> value) const;
  std::unique_ptr<State> state_;
};

}  // namespace ngs
