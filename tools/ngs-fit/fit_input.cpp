#include "fit_input.h"

#include "ngs/io/capture/sparse_points.h"
#include "ngs/io/image/photo.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/scene/scene_json.h"
#include "shared/scene/memory_model.h"

namespace ngs::cli {

std::vector<FitView> load_views(Run& run, const Scene& scene) {
  const auto timed = run.monitor().scope("load");
  std::vector<FitView> views;
  for (std::size_t i = 0; i < scene.views.size(); ++i) {
    PackedPhoto photo = io::read_packed_photo(scene, i);
    if (!photo.empty()) views.push_back({scene.views[i].camera, std::move(photo), scene.views[i].split});
  }
  if (views.size() < scene.views.size())
    run.monitor().warn(std::to_string(scene.views.size() - views.size()) + " views have no photo and are ignored");
  return views;
}

std::vector<FitPoint> load_points(Run& run, const FitOptions& options, const Input& input) {
  std::vector<FitPoint> points;
  if (!input) {
    run.monitor().warn("no --points: starting from random Gaussians, which needs more steps");
    return points;
  }
  for (const SparsePoint& p : io::read_points(input.path))
    points.push_back({{float(p.position.x), float(p.position.y), float(p.position.z)},
                      {float(p.rgb[0]) / 255.f, float(p.rgb[1]) / 255.f, float(p.rgb[2]) / 255.f}});
  if (points.empty())
    throw Error(ErrorCode::kNothingFound, input.path + ": no points, expected some to start from",
                "leave --points out to start from random points");
  if (points.size() > std::size_t(options.max_gaussians))
    run.monitor().warn("the fit starts from " + std::to_string(options.max_gaussians) + " of " +
                       std::to_string(points.size()) + " points, and adds none: that is the limit of --max-gaussians");
  return points;
}

Json fit_plan(const FitOptions& options, const Scene& scene, bool resumes, int threads) {
  std::vector<Camera> cameras;
  double photo_bytes = 0;
  for (std::size_t i = 0; i < scene.views.size(); ++i) {
    cameras.push_back(scene.views[i].camera);
    photo_bytes += io::packed_photo_bytes(scene, i);
  }
  const FitCost cost = fit_cost(options, cameras, photo_bytes);
  return {{"steps", options.steps},
          {"resumes", resumes},
          {"time_s", cost.cpu_s / threads},
          {"memory_mib", cost.memory_mib}};
}

std::string history(const FitOptions& options) {
  FitOptions copy = options;
  OptionSet set;
  set.add(copy);
  return io::history_line("ngs-fit", set.to_json().dump());
}

Json score_json(const FitScore& score) {
  return {{"views", score.views}, {"psnr_db", score.psnr_db}, {"ssim", score.ssim}};
}

Scene read_fit_scene(Run& run, const std::string& path, FitOptions& options) {
  Scene scene = io::read_scene_json(path);
  if (scene.compat != Compat::kInria)
    run.monitor().warn(
        "the scene has --compat gsplat, but this fit follows the rules of 3DGS: import the fitted model again");
  choose_background(options.background, run.monitor(), scene);
  options.background = background_text(background_of(scene));
  run.result()["views"] = scene.views.size();
  run.needs_device_memory(device_bytes(options.max_gaussians, sh_rest_count(options.sh_degree)));
  return scene;
}

}  // namespace ngs::cli
