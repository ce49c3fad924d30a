#pragma once
// Similarity of two images. Values in [0, 1], any number of channels; sizes must agree.
#include "ngs/backend/exec.h"
#include "ngs/scene/views.h"

namespace ngs {

/// Mean squared difference over pixels and channels, summed in double by rows. `weight` ([H, W, 1]) may be null;
/// NaN if all weights are 0.
double mean_squared_error(const Exec& exec, const ImageF& a, const ImageF& b, const ImageF* weight = nullptr);

/// -10 log10(MSE), dB; infinite for equal images.
double psnr_db(const Exec& exec, const ImageF& a, const ImageF& b, const ImageF* weight = nullptr);

/// The PSNR that reports give to equal images, the most that they give.
inline constexpr double kEqualPsnrDb = 100;

/// Mean SSIM, 3DGS's convention (ops/losses/photometric.h). With a weight, the mean over the weighted pixels; their
/// windows include the pixels around them.
double ssim_index(const Exec& exec, const ImageF& a, const ImageF& b, const ImageF* weight = nullptr);

}  // namespace ngs
