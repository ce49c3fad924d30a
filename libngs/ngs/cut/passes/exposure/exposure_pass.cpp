// Equalises the exposure and white balance of the photos.                                       paper.md §5.14
#include "ngs/cut/passes/exposure/exposure.h"
#include "ngs/cut/passes/pass.h"
#include "ngs/cut/passes/pass_list.h"
#include "ngs/problem/view_list.h"

namespace ngs {
namespace {

class ExposurePass : public Pass {
 public:
  PassStage stage() const override { return PassStage::kRepair; }
  std::vector<Effect> effects() const override;
  void run(PassRun& run) override;
};

double measured_spread(SceneProbe& probe) {
  const std::vector<std::size_t> some = spread_views(photo_views(probe.problem().scene), kDecisionViews);
  return exposure_spread_percent(view_exposures(probe.exec(), probe.problem(), some));
}

bool has_photos(const Problem& problem) { return !photo_views(problem.scene).empty(); }

}  // namespace

std::vector<Effect> ExposurePass::effects() const {
  return {{.name = "exposure",
           .help = "equalise exposure and white balance of the photos",
           .saves = "estimation of one gain per view and channel",
           .heuristic = {"largest deviation of a view's exposure from the median, percent", 2,
                         "two and a half levels of mid-grey", measured_spread, has_photos, "no view has a photo"}}};
}

void ExposurePass::run(PassRun& run) {
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
    return
        [exposures, load = std::move(load)](std::size_t view) { return equalised_photo(*exposures, view, load(view)); };
  };
  run.problem->load_photo = equalised(run.problem->load_photo);
  if (run.problem->load_fine_photo) run.problem->load_fine_photo = equalised(run.problem->load_fine_photo);
}

std::unique_ptr<Pass> make_exposure_pass() { return std::make_unique<ExposurePass>(); }

}  // namespace ngs
