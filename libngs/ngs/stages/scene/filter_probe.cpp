#include "ngs/stages/scene/filter_probe.h"

#include "ngs/stages/scene/pose_check.h"
#include "ngs/stages/render/render_options.h"

namespace ngs {

FilterProbe probe_filter(const Exec& exec, const GaussianCloud& cloud, const Scene& scene,
                         const std::vector<std::size_t>& views,
                         const std::function<ImageF(std::size_t view)>& load_photo) {
  FilterProbe probe;
  for (const double size : {1.0, 0.25, 0.5, 2.0, 4.0}) probe.candidates.push_back({0.3 / (size * size), 0});
  if (views.empty()) return probe;
  for (const std::size_t view : views) {
    const ImageF photo = load_photo(view);
    for (FilterCandidate& c : probe.candidates) {
      // over the background that fits best: it is not in the PLY, and over black the largest footprints would win
      SplatOptions splat = splat_options({}, cloud, scene);
      splat.blur_px2 = c.filter_px2;
      c.psnr_db += match_photo(exec, cloud, scene.views[view].camera, splat, photo).psnr_db / double(views.size());
    }
  }
  double best = probe.candidates.front().psnr_db + kFilterMarginDb;
  for (const FilterCandidate& c : probe.candidates)
    if (c.psnr_db > best) best = c.psnr_db, probe.filter_px2 = c.filter_px2;
  return probe;
}

}  // namespace ngs
