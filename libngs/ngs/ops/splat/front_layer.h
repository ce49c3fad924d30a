#pragma once
// The part of a view in front of a given surface, and each Gaussian's share of it.   paper.md §5.8
//
// A contribution at pixel p is in front if its Gaussian is a candidate with camera z < limit(p). limit 0: no surface at
// this pixel, nothing is in front. Weights w = α T are those of rendering the whole model.
#include <memory>

#include "ngs/math/row_numbers.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/scene/view_sums.h"

namespace ngs {

using Candidates = std::vector<std::uint8_t>;  // [N]

/// The candidates, with one row of values each.
struct RowValues {
  const RowNumbers& of;
  Matrix<const float> value;  // [of, C]
};

/// A surface in one view of a model. The view is projected once for several queries; Gaussians behind a tile's farthest
/// surface are culled.
class FrontView {
 public:
  /// `limit` [H, W, 1] camera z, world; it must outlive this object.
  FrontView(const Exec& exec, const GaussianCloud& cloud, const ImageF& limit, const Camera& camera,
            const SplatOptions& options);
  ~FrontView();
  FrontView(const FrontView&) = delete;
  FrontView& operator=(const FrontView&) = delete;

  /// [H, W, C + 1]: Σ w value, then Σ w, over the contributions in front.
  ImageF layer(const RowValues& values) const;
  /// [H, W, 1]: Σ w.
  ImageF layer(const Candidates& candidate) const;
  /// Per candidate with Σ w > 0, in no order: Σ w over the pixels where it is in front, and over the marked ones of
  /// these. `marked` [H·W].
  ViewSums sums(const Candidates& candidate, const std::vector<std::uint8_t>& marked) const;

 private:
  struct State;
  ImageF layer(const Candidates& candidate, const std::uint32_t* number, Matrix<const float> value) const;
  std::unique_ptr<State> state_;
};

}  // namespace ngs
