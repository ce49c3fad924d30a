// Trains a labelled model by the losses of BEA-GS and writes both halves, for tests/bench/results.sh halves.
//
//   ngs_occupancy SCENE LABELLED K OBJECT BACKGROUND
//
// K: points in a voxel (published: 2000). The rest as published: 3000 steps, weights 0.5 and 10, 20 samples. Rates are
// those of 3DGS at its last step. The scene is in 2D Gaussians there, with losses of depth and normals; here it is not.
#include <cstdlib>
#include <iostream>

#include "ngs/core/error.h"
#include "ngs/io/formats/write_splat.h"
#include "ngs/io/image/masks.h"
#include "ngs/io/image/photo.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/make/fit/fit_stage.h"
#include "ngs/ops/losses/photometric.h"
#include "ngs/problem/view_list.h"
#include "ngs/render/render_options.h"
#include "ngs/scene/mask_threshold.h"
#include "occupancy/occupancy_loss.h"

namespace ngs::bench {
namespace {

constexpr int kSteps = 3000;
constexpr double kBoundaryWeight = 0.5, kOccupancyWeight = 10, kFinalPositionRate = 1.6e-6;

struct Case {
  Scene scene;
  io::GaussianPly model;
  std::vector<std::uint8_t> object;                  // [N]
  std::vector<std::vector<std::uint8_t>> mask = {};  // [views][H·W]
  std::vector<std::size_t> views = {};
  SplatOptions splat = {};

  Case(const std::string& scene_path, const std::string& model_path)
      : scene(io::read_scene_json(scene_path)), model(io::read_gaussian_ply(model_path)) {
    const LabelColumns& labels = model.objects.empty() ? model.labels : model.objects.front().columns;
    for (std::int64_t i = 0; i < model.cloud.size(); ++i)
      object.push_back(label_is_foreground(labels.label[std::size_t(i)]));
    views = training_views(scene), mask.resize(scene.views.size());
    for (const std::size_t v : views) {
      const ViewMasks masks = io::load_masks(scene, v);
      for (const float m : masks.target.at(0)) mask[v].push_back(mask_is_foreground(m));
    }
    splat = splat_options({}, model.cloud, scene);
  }
};

/// The points of the rendered depth in the pixels of each class.
std::vector<float> depth_points(const Exec& exec, const Case& c, std::uint8_t of_class) {
  std::vector<float> points;
  for (const std::size_t v : c.views) {
    const Camera camera = relative_to(c.scene.views[v].camera, c.model.cloud.origin);
    RenderRequest request;
    request.colour = false, request.depth = true;
    const RenderedView view = render(exec, c.model.cloud, c.scene.views[v].camera, c.splat, request);
    for (int y = 0; y < camera.height_px; ++y)
      for (int x = 0; x < camera.width_px; ++x) {
        const float alpha = view.alpha.at(x, y);
        if (c.mask[v][view.alpha.index(x, y)] != of_class || alpha < 0.5f) continue;
        const double z = double(view.depth.at(x, y)) / double(alpha);
        const Vec3<double> local{z * (x + 0.5 - camera.cx) / camera.fx, z * (y + 0.5 - camera.cy) / camera.fy, z};
        const Vec3<double> p = transpose(camera.rotation) * (local - camera.translation);
        for (const double value : {p.x, p.y, p.z}) points.push_back(float(value));
      }
  }
  return points;
}

void train(const Exec& exec, Case& c, const Voxels (&voxels)[2]) {
  const std::vector<float> label(c.object.begin(), c.object.end());
  const FitOptions rates;
  const double extent = scene_extent(cameras_of(c.scene, c.views));
  const GroupRates group{
      kFinalPositionRate * extent, rates.rotation_lr, rates.scale_lr, rates.opacity_lr, rates.dc_lr, rates.rest_lr};
  SplatPass pass(c.splat);
  PhotometricPass<float> photometric;
  GaussianMoments moments;
  std::vector<std::size_t> order;
  for (int step = 0; step < kSteps; ++step) {
    const auto n = int(c.views.size());
    if (step % n == 0) order = shuffled(c.views, 0, std::uint64_t(step / n));
    const std::size_t v = order[std::size_t(step % n)];
    RenderRequest request;
    request.label = {label.data(), c.model.cloud.size(), 1}, request.background = background_of(c.scene);
    const RenderedView& rendered = pass.forward(exec, c.model.cloud, c.scene.views[v].camera, request);
    ViewGradients image;
    photometric.evaluate(exec, {}, {rendered.colour, io::load_photo(c.scene, v)}, &image.colour);
    const double bound = boundary_gradient(rendered, c.mask[v], kBoundaryWeight, image);
    CloudGradients gradients;
    pass.backward(exec, image, gradients);
    const double occupancy = add_occupancy_gradient({c.model.cloud, c.object, voxels}, {.step = std::uint64_t(step)},
                                                    kOccupancyWeight, gradients);
    step_gaussians(exec, {step + 1, group}, gradients, c.model.cloud, moments);
    if (step % 500 == 0) std::cerr << step << ": L_bound " << bound << ", L_occ " << occupancy << '\n';
  }
}

int run(int count, char** words) {
  if (count != 6) throw Error(ErrorCode::kUsage, "expected SCENE LABELLED K OBJECT BACKGROUND");
  Case c(words[1], words[2]);
  const Exec exec{.threads = 2};
  const int k = std::atoi(words[3]);
  if (k < 1) throw Error(ErrorCode::kUsage, std::string("K = ") + words[3] + ", expected a number of points");
  const Voxels voxels[2] = {Voxels(depth_points(exec, c, 0), k, 0), Voxels(depth_points(exec, c, 1), k, 0)};
  std::cerr << "voxels: " << voxels[0].side() << " (rest), " << voxels[1].side() << " (object)\n";
  train(exec, c, voxels);
  std::vector<std::uint8_t> rest;
  for (const std::uint8_t is_object : c.object) rest.push_back(!is_object);
  io::write_splat(words[4], {c.model, c.object});
  io::write_splat(words[5], {c.model, rest});
  return 0;
}

}  // namespace
}  // namespace ngs::bench

int main(int count, char** words) {
  try {
    return ngs::bench::run(count, words);
  } catch (const ngs::Error& error) {
    std::cerr << "ngs_occupancy: " << error.what() << '\n';
    return int(error.code());
  }
}
