#pragma once
// At which size was a model fitted? 3DGS adds a low-pass filter of 0.3 px² at the size it is fitted at.
// Rendered at another size with 0.3 px² again, footprints are too small (or too large), and so are masks. The
// filter that explains the photos best tells the fitting size.
#include <functional>
#include <vector>

#include "ngs/ops/splat/splat.h"
#include "ngs/scene/scene.h"

namespace ngs {

struct FilterCandidate {
  double filter_px2 = 0, psnr_db = 0;  // mean over the compared views, at the working size
};

struct FilterProbe {
  double filter_px2 = 0.3;  // the best; 0.3 unless another is better by kFilterMarginDb
  std::vector<FilterCandidate>
      candidates;  // 0.3 px² at 1/4, 1/2, 1, 2 and 4 times the working size, in working pixels
};
inline constexpr double kFilterMarginDb = 0.02;

/// Renders the `views` with each candidate. No views: 0.3 px².
FilterProbe probe_filter(const Exec& exec, const GaussianCloud& cloud, const Scene& scene,
                         const std::vector<std::size_t>& views,
                         const std::function<ImageF(std::size_t view)>& load_photo);

}  // namespace ngs
