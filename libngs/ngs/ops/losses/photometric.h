#pragma once
// The photometric loss of 3DGS and its gradient with respect to the rendered image.
//
//   L = (1 - λ) · mean |x - y| + λ · (1 - mean SSIM(x, y)),   λ = 0.2
//
// Means run over pixels and channels. SSIM uses an 11x11 Gaussian window (σ 1.5 px) per channel with zero padding,
// C1 = 1e-4, C2 = 9e-4, values in [0, 1]. With pixel weights w both means become Σ w · / Σ w. With a box, only its
// pixels count, but their windows include the pixels around it. If all weights are zero, loss and gradient are zero.
// Defined in photometric_impl.h, which tests instantiate for dual numbers.
#include <cstdint>

#include "ngs/backend/exec.h"
#include "ngs/ops/losses/photometric_kernels.h"

namespace ngs {

struct PixelRect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // px, half open; empty: the whole image
  bool empty() const { return x1 <= x0 || y1 <= y0; }
};

struct PhotometricOptions {
  double dssim_weight = 0.2;  // λ
  PixelRect box = {};
  double gradient_scale = 1;  // factor of the gradient
  double weight_sum = 0;      // Σ w if it is known; 0: computed from the weights, which must then be on the host
};

struct PhotometricLoss {
  double total = 0;
  double l1 = 0;    // mean |x - y|
  double ssim = 1;  // mean SSIM
};

/// Reuses its buffers between calls. T: float in production, double and Dual<double> in tests.
template <class T, class Acc = double>
class PhotometricPass {
 public:
  struct Value {
    Acc total, l1, ssim;
  };
  struct Images {
    const Image<T>&rendered, &target;
    const ImageF* weight = nullptr;  // [H, W, 1], >= 0; null: 1
  };

  /// `gradient` (overwritten, shaped like `rendered`) may be null.
  Value evaluate(const Exec& exec, const PhotometricOptions& options, const Images& in, Image<T>* gradient);

 private:
  Value compare(const Exec& exec, const ssim::Comparison<T>& c, double dssim_weight, double norm);

  std::vector<T> partials_;  // ∂L/∂(blurred moments), sized for the largest image so far
  std::vector<Acc> sums_;    // per work item
};
extern template class PhotometricPass<float, double>;
extern template class PhotometricPass<double, double>;

}  // namespace ngs
