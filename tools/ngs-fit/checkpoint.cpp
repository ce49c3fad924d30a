#include "checkpoint.h"

#include <cmath>

#include "ngs/core/error.h"
#include "ngs/io/capture/sparse_points.h"
#include "ngs/io/files/safetensors.h"
#include "ngs/io/image/photo.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/scene/scene_json.h"
#include "shared/scene/scene_model.h"

namespace ngs::cli {
namespace {

Json pose_of(const Camera& c) {
  return {c.fx, c.fy, c.cx, c.cy, c.rotation.m, {c.translation.x, c.translation.y, c.translation.z}};
}

}  // namespace

std::string fit_identity(const FitOptions& options, std::uint64_t seed, const std::vector<FitView>& views,
                         const FitFiles& files) {
  FitOptions copy = options;
  OptionSet set;
  set.add(copy);
  Json json = {{"options", set.to_json()},
               {"seed", seed},
               {"photos", files.photos},
               {"points", files.points},
               {"views", Json::array()}};
  for (const FitView& v : views)
    json["views"].push_back(
        {v.camera.name, v.camera.width_px, v.camera.height_px, v.split == Split::kTrain, pose_of(v.camera)});
  return json.dump();
}

std::string checkpoint_path(const std::string& folder) { return folder + "/fit.safetensors"; }

void write_checkpoint(const std::string& folder, const FitState& state, const std::string& identity) {
  io::TensorFile file;
  file.metadata = {{"ngs", "ngs-fit checkpoint 1"}, {"identity", identity}};
  file.add("step", {1}, std::vector<std::int64_t>{state.step});
  const GaussianCloud& cloud = state.cloud;
  const std::int64_t n = cloud.size();
  for (std::size_t g = 0; g < kGaussianGroups; ++g) {
    const std::string name = kGroupColumns[g].name;
    file.add(name, {n, group_width(cloud, g)}, cloud.*kGroupColumns[g].value);
    file.add(name + ".m", {std::int64_t(state.moments[g].m.size())}, state.moments[g].m);
    file.add(name + ".v", {std::int64_t(state.moments[g].v.size())}, state.moments[g].v);
  }
  file.add("gradient_sum", {n}, state.gradient_sum);
  file.add("gradient_views", {n}, state.gradient_views);
  io::write_safetensors(checkpoint_path(folder), file);
}

FitState read_checkpoint(const std::string& folder, const std::string& identity, std::int64_t steps) {
  const std::string path = checkpoint_path(folder);
  const io::TensorFile file = io::read_safetensors(path);
  if (file.meta("identity") != identity)
    throw Error(ErrorCode::kInconsistent,
                path + ": belongs to another run, expected the same options, seed, views, photos and points",
                "repeat the options of the interrupted run on the same files, or leave out --resume");
  for (const io::Tensor& tensor : file.tensors)
    if (tensor.type == io::TensorType::kF32)
      for (const float value : file.get<float>(tensor.name))
        if (!std::isfinite(value))
          throw Error(ErrorCode::kBadInput,
                      path + ": " + tensor.name + " has a value that is not finite, expected finite numbers",
                      "delete the checkpoint");
  FitState state;
  const std::int64_t n = std::int64_t(file.get<float>("logit_opacity").size());
  const std::vector<float> rest = file.get<float>("sh_rest");
  int degree = 0;
  while (degree < 3 && n > 0 && 3 * sh_rest_count(degree) * n != std::int64_t(rest.size())) ++degree;
  state.cloud.resize(n, degree);
  for (std::size_t g = 0; g < kGaussianGroups; ++g) {
    const std::string name = kGroupColumns[g].name;
    state.cloud.*kGroupColumns[g].value = file.get<float>(name, {n, group_width(state.cloud, g)});
    const auto moments = [&](const std::string& kind) {
      std::vector<float> values = file.get<float>(name + kind);
      if (!values.empty() && values.size() != (state.cloud.*kGroupColumns[g].value).size())
        throw Error(ErrorCode::kBadInput, path + ": " + name + kind + " has " + std::to_string(values.size()) +
                                              " values, expected none or one per parameter");
      return values;
    };
    state.moments[g] = {moments(".m"), moments(".v")};
  }
  state.gradient_sum = file.get<float>("gradient_sum", {n});
  state.gradient_views = file.get<float>("gradient_views", {n});
  state.step = file.get<std::int64_t>("step", {1})[0];
  if (state.step < 0 || state.step > steps || n == 0)
    throw Error(ErrorCode::kBadInput,
                path + ": step " + std::to_string(state.step) + " of " + std::to_string(steps) + " with " +
                    std::to_string(n) + " Gaussians, expected a valid state",
                "delete the checkpoint");
  return state;
}

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
