#pragma once
// The mask loss and the continuity of colours on a device.                                    Eqs. (17), (19)
#include "ngs/ops/losses/loss_cont_kernels.h"
#include "ngs/ops/losses/loss_mask_kernels.h"
#include "ngs/ops/optim/row_kernels.h"

namespace ngs {

/// Pixel i of the mask loss.
struct MaskLossPixel {
  static constexpr const char* kName = "mask_loss_pixel";
  static constexpr int kInlinePlanes = 16;
  MaskLossRow<float, double> row;
  const float* target[kInlinePlanes];  // instead of row.target if that is null
  double* term;                        // [pixels] out
  NGS_HD void operator()(std::int64_t i) const {
    MaskLossRow<float, double> own = row;
    if (own.target == nullptr) own.target = target;
    double sum = 0;
    own.pixel(i, sum);
    term[i] = sum;
  }
};

/// Point i of the continuity of colours: its term, its gradient, and the row to which the gradient is added.
struct ContinuityRow {
  static constexpr const char* kName = "continuity_row";
  ContinuityForward<float> forward;
  ContinuityBackward<float> backward;
  AddRowColourGradients add;  // null `place`: not wanted
  NGS_HD void operator()(std::int64_t i) const {
    forward(i);
    backward(i);
    if (add.place != nullptr) add(i);
  }
};

}  // namespace ngs
