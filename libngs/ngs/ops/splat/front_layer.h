#pragma once
// What of a view lies in front of a given surface, and how much of each Gaussian does.   PAPER.md §5.8
//
// A contribution is in front of pixel p where its Gaussian is a candidate and its camera z is below limit(p);
// limit 0: no surface at this pixel, nothing is in front. Weights w = α T are those of rendering the whole model.
#include <limits>
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

/// A model, and what is known of the surface of all queries: it lies in tiles that one of `where` reaches, and no
/// farther from the camera than `far_z`.
struct FrontModel {
  const GaussianCloud& cloud;
  const std::uint8_t* where = nullptr;                   // [N] null: anywhere
  float far_z = std::numeric_limits<float>::infinity();  // world
};

/// One view of a model, projected once for several looks at it.
class FrontView {
 public:
  FrontView(const Exec& exec, const FrontModel& model, const Camera& camera, const SplatOptions& options);
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
