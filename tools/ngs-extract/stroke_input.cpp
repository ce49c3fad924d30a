#include "stroke_input.h"

#include "ngs/core/error.h"
#include "ngs/cut/masks/rasterise_prompt.h"
#include "ngs/render/render_options.h"

namespace ngs::cli {

void check_strokes(Run& run, const Inputs& strokes, const Input& scene) {
  if (strokes && !scene) throw Error(ErrorCode::kUsage, "--strokes needs the cameras", "give --scene scene.json");
  if (!strokes) run.warn_unused({"--view"}, "without --strokes");
}

std::vector<ViewSums> stroke_weights_of(const Run& run, const Scene& scene, const Marks& marks,
                                        const GaussianCloud& cloud) {
  const SplatOptions splat = prepared_for(run.exec(), splat_options({}, cloud, scene), cloud);
  std::vector<ViewSums> strokes;
  for (const auto& [view, hand] : marks) {
    const Camera& camera = scene.views[view].camera;
    const ViewPrompt prompt = rasterise(hand, camera.width_px, camera.height_px);
    for (ViewSums& stroke : stroke_weights(run.exec(), cloud, camera, prompt, splat))
      strokes.push_back(std::move(stroke));
  }
  return strokes;
}

}  // namespace ngs::cli
