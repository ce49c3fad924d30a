// Losses of a crop give the same gradients as losses of the full image for the Gaussians that the crop covers: with all
// others fixed, a gradient depends only on the pixels that a Gaussian reaches and the SSIM windows over these.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>

#include "ngs/core/monitor.h"
#include "ngs/cut/contours/refined_masks.h"
#include "ngs/cut/evidence/variance_stage.h"
#include "ngs/io/image/masks.h"
#include "ngs/io/image/photo.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/scene/import_scene.h"
#include "ngs/ops/losses/loss_mask.h"
#include "ngs/ops/losses/photometric.h"
#include "ngs/ops/optim/adam.h"
#include "ngs/ops/splat/splat_view.h"
#include "support/joint_case.h"
#include "support/skip.h"

namespace ngs {
namespace {

constexpr int kSsimRadius_px = 5;
// Relative to the largest gradient of a block, and to the largest movement: rounding error.
constexpr double kGradientBound = 1e-8, kStepBound = 1e-6;

/// A view, and a model with its trained rows.
struct View {
  Camera camera;
  ImageF photo;
  ViewMasks masks;
};
struct Model {
  GaussianCloud cloud;
  std::vector<float> label;           // [N]
  std::vector<std::uint8_t> trained;  // [N]
};

PixelWindow grown(const PixelWindow& w, int by_px, const Camera& camera, int grid_px = 1) {
  const int x0 = std::max(0, w.x0 - by_px) / grid_px * grid_px, y0 = std::max(0, w.y0 - by_px) / grid_px * grid_px;
  return {x0, y0, std::min(camera.width_px, w.x0 + w.w + by_px) - x0,
          std::min(camera.height_px, w.y0 + w.h + by_px) - y0};
}

/// The window of the pixels that trained Gaussians reach.
PixelWindow reached(const Model& model, const Camera& camera) {
  RenderRequest request{.colour = false, .label = {}, .include = model.trained.data()};
  const ImageF alpha = render({}, model.cloud, camera, {}, request).alpha;
  return window_of({alpha.data}, camera.width_px, camera.height_px, 0);
}

ImageF crop(const ImageF& image, const PixelWindow& w) {
  ImageF out(w.w, w.h, image.channels);
  out.data = cropped(image.data, image.width_px, image.channels, w);
  return out;
}

/// Colour and mask losses of a full image, or of a crop scaled to its share of the full image.
struct Step {
  PixelRect box;  // of the colour loss; empty: all
  double photo_share = 1, mask_share = 1;

  void gradients(const Model& model, const View& view, CloudGradients& out) const {
    RenderRequest request{.label = {model.label.data(), model.cloud.size(), 1}};
    SplatPass pass{SplatOptions{}};
    const RenderedView& rendered = pass.forward({}, model.cloud, view.camera, request);
    ViewGradients grad;
    grad.label_moves_geometry = true;
    PhotometricPass<float>().evaluate({}, {.box = box, .gradient_scale = photo_share}, {rendered.colour, view.photo},
                                      &grad.colour);
    loss_mask({}, {}, {&rendered.label, &view.masks, nullptr, 1.0}, 0.5 * mask_share, &grad.label);
    pass.backward({}, grad, out);
  }
};

struct Cropped {
  View view;
  Step step;
};
/// Disables Gaussians beyond the clamp of the projection's Jacobian, 0.15 image sizes outside the crop: the clamp
/// depends on the crop, so these are projected differently. Returns whether any was disabled; the crop may then shrink.
bool keep_within_limits(const Camera& crop, GaussianCloud& cloud) {
  bool changed = false;
  const Camera camera = relative_to(crop, cloud.origin);
  for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i) {
    const float* p = &cloud.position[3 * i];
    const Vec3<double> at =
        camera.rotation * Vec3<double>{double(p[0]), double(p[1]), double(p[2])} + camera.translation;
    const double u = camera.fx * at.x / at.z + camera.cx, v = camera.fy * at.y / at.z + camera.cy;
    const double margin_x = 0.15 * camera.width_px, margin_y = 0.15 * camera.height_px;
    if (!(u > -margin_x && v > -margin_y && u < camera.width_px + margin_x && v < camera.height_px + margin_y)) {
      changed |= cloud.usable[i] != 0;
      cloud.usable[i] = 0;
    }
  }
  return changed;
}

Cropped cropped_to(const Model& model, const View& whole) {
  const PixelWindow loss = grown(reached(model, whole.camera), kSsimRadius_px, whole.camera),
                    window =
                        grown(loss, kSsimRadius_px, whole.camera, kTilePx);  // aligned to the tiles of the full image
  Cropped c{.view = {window_camera(whole.camera, window), crop(whole.photo, window), whole.masks}, .step = {}};
  c.view.masks.width_px = window.w;
  c.view.masks.height_px = window.h;
  c.view.masks.target = {cropped(whole.masks.target[0], whole.camera.width_px, 1, window)};
  if (!whole.masks.known.empty()) c.view.masks.known = cropped(whole.masks.known, whole.camera.width_px, 1, window);
  const auto known = [](const ViewMasks& m) {
    return m.known.empty() ? double(m.target[0].size())
                           : double(std::count(m.known.begin(), m.known.end(), std::uint8_t(1)));
  };
  c.step.box = {loss.x0 - window.x0, loss.y0 - window.y0, loss.x0 - window.x0 + loss.w, loss.y0 - window.y0 + loss.h};
  c.step.photo_share = double(loss.w) * loss.h / double(whole.photo.pixels());
  c.step.mask_share = known(c.view.masks) / known(whole.masks);
  return c;
}

/// Largest difference of the trained rows relative to their largest value; -1 if all are zero.
double difference(const std::vector<float>& a, const std::vector<float>& b, const std::vector<std::uint8_t>& trained) {
  const std::size_t columns = a.size() / trained.size();
  double worst = 0, largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!trained[i / columns]) continue;
    worst = std::max(worst, std::abs(double(a[i]) - double(b[i])));
    largest = std::max(largest, std::abs(double(a[i])));
  }
  return largest > 0 ? worst / largest : -1;
}
double worst_difference(const CloudGradients& a, const CloudGradients& b, const std::vector<std::uint8_t>& trained) {
  double worst = 0;
  for (const auto column : {&CloudGradients::position, &CloudGradients::rotation, &CloudGradients::log_scale,
                            &CloudGradients::logit_opacity, &CloudGradients::sh_dc, &CloudGradients::label}) {
    const double d = difference(a.*column, b.*column, trained);
    REQUIRE(d >= 0);  // a block without any gradient would prove nothing
    worst = std::max(worst, d);
  }
  return worst;
}

/// Trains the trained rows with Adam for a few steps over the views.
Model trained_for(int steps, Model model, const std::vector<View>& views, const std::vector<Step>& step) {
  CloudGradients g;
  AdamMoments position, scale, colour, label;
  for (int s = 0; s < steps; ++s) {
    const auto v = std::size_t(s) % views.size();
    step[v].gradients(model, views[v], g);
    const auto move = [&](const char* name, std::vector<float>& value, std::vector<float>& gradient, AdamMoments& m) {
      const std::size_t columns = value.size() / model.trained.size();
      for (std::size_t i = 0; i < gradient.size(); ++i)
        if (!model.trained[i / columns]) gradient[i] = 0;
      adam_step({}, {.lr = 1e-3}, s + 1, {name, value, gradient}, m);
    };
    move("position", model.cloud.position, g.position, position);
    move("log_scale", model.cloud.log_scale, g.log_scale, scale);
    move("sh_dc", model.cloud.sh_dc, g.sh_dc, colour);
    move("label", model.label, g.label, label);
  }
  return model;
}

}  // namespace

TEST_CASE("a crop around the trained Gaussians gives the gradients and Adam steps of the full image") {
  const auto c = test::joint_case();
  Model model{c->model, std::vector<float>(c->is_ball.size(), 0.4f), {}};
  for (std::size_t i = 0; i < c->is_ball.size(); ++i)
    model.trained.push_back(c->is_ball[i] > 0 && c->model.position[3 * i] > 0.45f &&
                            std::abs(c->model.position[3 * i + 1]) < 0.2f);
  std::int64_t whole_px = 0, part_px = 0;
  double worst = 0;
  std::vector<View> whole, part;
  std::vector<Step> whole_step, part_step;
  for (std::size_t v = 0; v < 4; ++v) {
    whole.push_back({c->scene.views[v].camera, c->photos[v], c->masks[v]});
    whole_step.emplace_back();
    if (v == 1) {
      whole.back().masks.known.assign(whole.back().masks.target[0].size(), 1);
      whole.back().masks.known[0] = 0;
    }
    const Cropped cropped = cropped_to(model, whole.back());
    part.push_back(cropped.view);
    part_step.push_back(cropped.step);
    whole_px += whole.back().photo.pixels();
    part_px += part.back().photo.pixels();
    CloudGradients all, some;
    whole_step[v].gradients(model, whole[v], all);
    part_step[v].gradients(model, part[v], some);
    worst = std::max(worst, worst_difference(all, some, model.trained));
  }
  MESSAGE("worst difference of a gradient " << worst);
  CHECK(worst < kGradientBound);
  CHECK(part_px < whole_px * 9 / 10);
  const Model a = trained_for(8, model, whole, whole_step), b = trained_for(8, model, part, part_step);
  CHECK(a.cloud.position != model.cloud.position);
  const auto moved = [&](const std::vector<float>& from, const std::vector<float>& x, const std::vector<float>& y) {
    double most = 0, difference = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      most = std::max(most, std::abs(double(x[i]) - double(from[i])));
      difference = std::max(difference, std::abs(double(x[i]) - double(y[i])));
    }
    return difference / most;
  };
  MESSAGE("after 8 steps positions differ by " << moved(model.cloud.position, a.cloud.position, b.cloud.position)
                                               << " of the largest movement");
  CHECK(moved(model.cloud.position, a.cloud.position, b.cloud.position) < kStepBound);
  CHECK(moved(model.cloud.log_scale, a.cloud.log_scale, b.cloud.log_scale) < kStepBound);
  CHECK(moved(model.cloud.sh_dc, a.cloud.sh_dc, b.cloud.sh_dc) < kStepBound);
  CHECK(moved(model.label, a.label, b.label) < kStepBound);
}

TEST_CASE("a crop around the boundary of a real capture gives the gradients of the full image") {
  const std::filesystem::path bird = std::filesystem::path(NGS_SOURCE_DIR) / ".." / "shared" / "scenes" / "bird";
  if (!std::filesystem::exists(bird / "point_cloud.ply")) return test::skip("no scene bird in ../shared/scenes");
  io::ImportRequest request;
  request.capture.source = bird.string();
  request.masks_dir = (bird / "masks_sam").string();
  request.image_scale = 0.5;
  const Scene scene = io::import_scene(request).scene;
  Model model{io::read_gaussian_ply(scene.model_path).cloud, {}, {}};
  const std::vector<std::size_t> views = {0, 5, 10, 15};
  const auto load = [&](std::size_t v) { return io::load_masks(scene, v); };
  const LabelColumns labels =
      label_gaussians({}, accumulate_evidence({}, test::Quiet(), {model.cloud, scene, views, {}, load}))[0];
  model.label = labels.prob.values();
  for (const float b : labels.boundary) model.trained.push_back(b > 0);
  for (const std::size_t v : {views[0], views[2]}) {
    const View whole{scene.views[v].camera, io::load_photo(scene, v), io::load_masks(scene, v)};
    while (keep_within_limits(cropped_to(model, whole).view.camera, model.cloud)) continue;
    const Cropped part = cropped_to(model, whole);
    CloudGradients all, some;
    const double start = wall_seconds();
    Step{}.gradients(model, whole, all);
    const double middle = wall_seconds();
    part.step.gradients(model, part.view, some);
    MESSAGE("crop " << part.view.camera.width_px << "x" << part.view.camera.height_px << " of " << whole.camera.width_px
                    << "x" << whole.camera.height_px << ", time " << middle - start << " s and "
                    << wall_seconds() - middle << " s, worst difference "
                    << worst_difference(all, some, model.trained));
    CHECK(worst_difference(all, some, model.trained) < kGradientBound);
  }
}

}  // namespace ngs
