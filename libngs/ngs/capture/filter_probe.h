#pragma once
// Estimates the image size at which a model was fitted. 3DGS adds a low-pass filter of 0.3 px² at the size of the fit.
// At another size the same 0.3 px² make footprints, and so masks, too small or too large. The filter with the highest
// PSNR against the photos gives the size of the fit.
#include <vector>

#include "ngs/core/monitor.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/render/background.h"

namespace ngs {

struct FilterCandidate {
  double filter_px2 = 0, psnr_db = 0;  // mean over the compared views, at the working size
};

struct FilterProbe {
  double filter_px2 = 0.3;                  // the best; 0.3 unless another one is better by kFilterMarginDb
  std::vector<FilterCandidate> candidates;  // in the order in which they were tried
};
inline constexpr double kFilterMarginDb = 0.02;

/// Renders the `views` with 0.3 px² at the working size and at 1/2 of it. If 1/2 is better, 1/4 is tried as well;
/// otherwise 2 times the size and, if that is better, 4 times. Assumes that the mean PSNR has one maximum over the
/// filter. Without views: 0.3 px².
FilterProbe probe_filter(const Exec& exec, Monitor& monitor, const PhotographedModel& model,
                         const std::vector<std::size_t>& views);

}  // namespace ngs
