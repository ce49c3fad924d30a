#include "ngs/capture/filter_probe.h"

#include "ngs/capture/pose_check.h"
#include "ngs/render/render_options.h"

namespace ngs {
namespace {

constexpr double kFilter_px2 = 0.3;  // at the size of the fit
constexpr std::int64_t kUsualCandidates = 3, kMaxCandidates = 4;

/// Measures candidates one after the other.
class Trials {
 public:
  Trials(const Exec& exec, Monitor& monitor, const PhotographedModel& model, const std::vector<std::size_t>& views)
      : exec_(exec),
        monitor_(monitor),
        model_(model),
        views_(views),
        splat_(prepared_for(exec, splat_options({}, model.cloud, model.scene), model.cloud)) {}

  /// The PSNR with the filter of a fit at `size` times the working size.
  FilterCandidate at(double size) {
    FilterCandidate c{kFilter_px2 / (size * size), 0};
    SplatOptions splat = splat_;
    splat.blur_px2 = c.filter_px2;
    const std::int64_t passes = std::int64_t(views_.size());
    for (const std::size_t v : views_) {
      // Over the best-fitting background: it is not in the PLY, and over black the largest footprints would win.
      const PhotoView view{model_.scene.views[v].camera, model_.load_photo(v)};
      c.psnr_db += match_photo(exec_, model_.cloud, view, splat).psnr_db / double(passes);
      ++done_;
      monitor_.progress(done_, passes * (done_ > passes * kUsualCandidates ? kMaxCandidates : kUsualCandidates));
    }
    return c;
  }

 private:
  const Exec& exec_;
  Monitor& monitor_;
  const PhotographedModel& model_;
  const std::vector<std::size_t>& views_;
  SplatOptions splat_;
  std::int64_t done_ = 0;
};

}  // namespace

FilterProbe probe_filter(const Exec& exec, Monitor& monitor, const PhotographedModel& model,
                         const std::vector<std::size_t>& views) {
  FilterProbe probe;
  if (views.empty()) return probe;
  Trials trials(exec, monitor, model, views);
  std::vector<FilterCandidate>& tried = probe.candidates;
  tried = {trials.at(1), trials.at(0.5)};
  const bool smaller = tried[1].psnr_db > tried[0].psnr_db;
  tried.push_back(trials.at(smaller ? 0.25 : 2));
  if (!smaller && tried[2].psnr_db > tried[0].psnr_db) tried.push_back(trials.at(4));
  double best = tried[0].psnr_db + kFilterMarginDb;
  for (const FilterCandidate& c : tried)
    if (c.psnr_db > best) {
      best = c.psnr_db;
      probe.filter_px2 = c.filter_px2;
    }
  return probe;
}

}  // namespace ngs
