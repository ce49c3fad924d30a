#include "ngs/cut/passes/exposure/exposure.h"

#include <algorithm>
#include <cmath>

#include "ngs/cut/passes/pass.h"
#include "ngs/cut/passes/pass_list.h"
#include "ngs/math/median.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/problem/view_list.h"

namespace ngs {
namespace {

constexpr float kSolid = 0.9f;                    // minimum opacity of a compared pixel
constexpr float kDark = 0.08f, kClipped = 0.97f;  // range of photo and rendering in which a ratio is meaningful
constexpr std::size_t kMinPixels = 256;
constexpr double kMaxLogGain = 1.4;  // two stops: beyond it photo and rendering differ in content

double measured_spread(SceneProbe& probe) {
  const std::vector<std::size_t> some = spread_views(photo_views(probe.problem().scene), kDecisionViews);
  return exposure_spread_percent(view_exposures(probe.exec(), probe.problem(), some));
}

bool some_view_has_photo(const Problem& problem) { return !photo_views(problem.scene).empty(); }

/// Median over the pixels of ln(photo / rendering); NaN: too few pixels.
double log_gain(const RenderedView& rendered, const ImageF& photo, std::size_t channel) {
  std::vector<double> ratio;
  for (std::size_t p = 0; p < rendered.alpha.data.size(); ++p) {
    const float a = photo.data[3 * p + channel], b = rendered.colour.data[3 * p + channel];
    const bool comparable = rendered.alpha.data[p] > kSolid && std::min(a, b) > kDark && std::max(a, b) < kClipped;
    if (comparable) ratio.push_back(double(a) / double(b));
  }
  return ratio.size() < kMinPixels ? NAN : std::log(upper_median(std::move(ratio)));
}

/// Equalises the exposure and white balance of the photos.                                       paper.md §5.14
class ExposurePass : public Pass {
 public:
  ExposurePass() : Pass({PassStage::kRepair}) {}
  std::vector<Effect> effects() const override {
    return {{.name = "exposure",
             .help = "equalise exposure and white balance of the photos",
             .saves = "estimation of one gain per view and channel",
             .heuristic = {"largest deviation of a view's exposure from the median, percent", 2,
                           "two and a half levels of mid-grey", measured_spread, some_view_has_photo,
                           "no view has a photo"}}};
  }
  void run(PassRun& run) override {
    const auto timed = run.monitor.scope("exposure");
    const Scene& scene = run.problem->scene;
    const auto exposures =
        std::make_shared<const std::vector<ViewExposure>>(view_exposures(run.exec, *run.coarse, photo_views(scene)));
    if (run.monitor.stop_requested()) return;
    Json gains = Json::object();
    for (const ViewExposure& e : *exposures) gains[scene.views[e.view].camera.name] = e.gain;
    run.report["exposure"] = {{"gains", gains}};
    if (exposures->empty()) return;
    const auto equalised = [&exposures](std::function<ImageF(std::size_t)> load) {
      return [exposures, load = std::move(load)](std::size_t view) {
        return equalised_photo(*exposures, view, load(view));
      };
    };
    run.problem->load_photo = equalised(run.problem->load_photo);
    if (run.problem->load_fine_photo) run.problem->load_fine_photo = equalised(run.problem->load_fine_photo);
  }
};

}  // namespace

std::vector<ViewExposure> view_exposures(const Exec& exec, const Problem& input,
                                         const std::vector<std::size_t>& views) {
  std::vector<ViewExposure> exposures;
  std::vector<std::array<double, 3>> logs;
  const SplatOptions splat = prepared_for(exec, input.splat, input.cloud);
  for_each_view(input.monitor, views, [&](std::size_t, std::size_t v) {
    const ImageF photo = input.load_photo(v);
    if (photo.empty()) return;
    RenderRequest request;
    request.background = input.background;
    const RenderedView rendered = render(exec, input.cloud, input.scene.views[v].camera, splat, request);
    exposures.push_back({v});
    logs.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) logs.back()[c] = log_gain(rendered, photo, c);
  });
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<double> known;
    for (const auto& log : logs)
      if (!std::isnan(log[c])) known.push_back(log[c]);
    if (known.empty()) continue;
    const double median = upper_median(known);
    for (std::size_t i = 0; i < logs.size(); ++i)
      if (!std::isnan(logs[i][c]))
        exposures[i].gain[c] = float(std::exp(std::clamp(logs[i][c] - median, -kMaxLogGain, kMaxLogGain)));
  }
  return exposures;
}

double exposure_spread_percent(const std::vector<ViewExposure>& exposures) {
  double worst = 0;
  for (const ViewExposure& e : exposures)
    for (const float g : e.gain) worst = std::max(worst, std::abs(std::log(double(g))));
  return 100 * std::expm1(worst);
}

ImageF equalised_photo(const std::vector<ViewExposure>& exposures, std::size_t view, ImageF photo) {
  const auto known =
      std::find_if(exposures.begin(), exposures.end(), [&](const ViewExposure& e) { return e.view == view; });
  if (known == exposures.end()) return photo;
  for (std::size_t i = 0; i < photo.data.size(); ++i) photo.data[i] /= known->gain[i % 3];
  return photo;
}

std::unique_ptr<Pass> make_exposure_pass() { return std::make_unique<ExposurePass>(); }

}  // namespace ngs
