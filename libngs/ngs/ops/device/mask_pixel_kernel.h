#pragma once
// The mask loss on a device, pixel by pixel.                                                        Eq. (19)
#include "ngs/ops/losses/loss_mask_kernels.h"

namespace ngs {

/// Pixel i of the mask loss.
struct MaskLossPixel {
  static constexpr const char* kName = "mask_loss_pixel";
  MaskLossRow<float, double> row;
  double* term;  // [pixels] out
  NGS_HD void operator()(std::int64_t i) const {
    double sum = 0;
    row.pixel(i, sum);
    term[i] = sum;
  }
};

}  // namespace ngs
