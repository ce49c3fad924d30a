#pragma once
// At which size was a model fitted? 3DGS adds a low-pass filter of 0.3 px² at the size it is fitted at.
// Rendered at another size with 0.3 px² again, footprints are too small (or too large), and so are masks. The
// filter that explains the photos best tells the fitting size.
#include <vector>

#include "ngs/core/monitor.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/stages/render/photographed_model.h"

namespace ngs {

struct FilterCandidate {
  double filter_px2 = 0, psnr_db = 0;  // mean over the compared views, at the working size
};

struct FilterProbe {
  double filter_px2 = 0.3;                  // the best; 0.3 unless another is better by kFilterMarginDb
  std::vector<FilterCandidate> candidates;  // those tried, in this order
};
inline constexpr double kFilterMarginDb = 0.02;

/// Renders the `views` with 0.3 px² at the working size, then at 1/2 of it and, where that is better, at 1/4; else at
/// 2 times it and, where that is better, at 4 times. The mean PSNR is taken to have one maximum over the filter. No
/// views: 0.3 px².
FilterProbe probe_filter(const Exec& exec, Monitor& monitor, const PhotographedModel& model,
                         const std::vector<std::size_t>& views);

}  // namespace ngs
