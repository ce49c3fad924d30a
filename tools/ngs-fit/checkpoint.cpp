#include "checkpoint.h"

#include <cmath>

#include "ngs/core/error.h"
#include "ngs/io/files/safetensors.h"

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

}  // namespace ngs::cli
