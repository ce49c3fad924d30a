#pragma once
// What of a view lies in front of a given surface, and how much of each Gaussian does.   PAPER.md §5.8
//
// A contribution is in front of pixel p where its Gaussian is a candidate and its camera z is below limit(p);
// limit 0: no surface at this pixel, nothing is in front. Weights w = α T are those of rendering the whole model.
#include <memory>

#include "ngs/ops/splat/splat.h"

namespace ngs {

struct FrontQuery {
  const ImageF& limit;                         // [H, W, 1] camera z, world
  const std::vector<std::uint8_t>& candidate;  // [N]
};

/// Σ w over the view's pixels where a Gaussian is in front, and over the marked of these, of those where it is not 0.
struct FrontSums {
  std::vector<std::uint32_t> row;     // index into the cloud, each once
  std::vector<double> front, marked;  // [rows]
};

/// One view of a model, projected once for several looks at it.
class FrontView {
 public:
  /// `include` [N] 1: drawn; null: all are.
  FrontView(const Exec& exec, const GaussianCloud& cloud, const Camera& camera, const SplatOptions& options,
            const std::uint8_t* include = nullptr);
  ~FrontView();
  FrontView(const FrontView&) = delete;
  FrontView& operator=(const FrontView&) = delete;

  /// [H, W, C + 1]: Σ w value and, last, Σ w, over the contributions in front. `value` [N, C].
  ImageF layer(const FrontQuery& query, Matrix<const float> value) const;
  /// `marked` [H·W].
  FrontSums sums(const FrontQuery& query, const std::vector<std::uint8_t>& marked) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ngs
