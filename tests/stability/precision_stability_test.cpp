// Closed-form labels and masks of the float kernels against the same kernels in double, on a real capture. Skipped if
// the capture is not available.
#include <doctest/doctest.h>

#include <filesystem>

#include "ngs/cut/evidence/variance_stage.h"
#include "ngs/io/image/masks.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/scene/import_scene.h"
#include "ngs/ops/image/metrics.h"
#include "ngs/ops/splat/cloud_view.h"
#include "ngs/ops/splat/splat_engine.h"
#include "ngs/ops/splat/tile_kernels_of.h"
#include "ngs/ops/splat/tile_scratch.h"
#include "ngs/problem/view_list.h"
#include "ngs/render/render_options.h"
#include "support/projected_view.h"
#include "support/skip.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
const fs::path kScene = fs::path(NGS_SOURCE_DIR) / ".." / "shared" / "scenes" / "bird";

/// A cloud's columns in double.
struct DoubleCloud {
  std::vector<double> position, rotation, log_scale, logit_opacity;
  CloudView<double> view;
  explicit DoubleCloud(const GaussianCloud& c)
      : position(c.position.begin(), c.position.end()),
        rotation(c.rotation.begin(), c.rotation.end()),
        log_scale(c.log_scale.begin(), c.log_scale.end()),
        logit_opacity(c.logit_opacity.begin(), c.logit_opacity.end()) {
    view = {c.size(), position.data(), rotation.data(), log_scale.data(), logit_opacity.data(), nullptr, nullptr, 0,
            0,        c.usable.data(), nullptr};
  }
};

/// Adds W and W1 of one view, summed in double throughout.
void add_double_evidence(const DoubleCloud& cloud, const Camera& camera, const SplatOptions& options,
                         const ViewMasks& masks, std::vector<double>& weight, std::vector<double>& object) {
  const ProjectedView<double> view = project_view({}, cloud.view, camera, options);
  const TileLists lists = bin_tiles({}, view, camera.width_px, camera.height_px);
  std::vector<double> pair(std::size_t(lists.pairs()) * 4, 0.0);
  const float* target = masks.target[0].data();
  const std::uint8_t* known = masks.known.empty() ? nullptr : masks.known.data();
  TileScratch<double> scratch;
  for (std::int64_t tile = 0; tile < lists.tiles(); ++tile)
    tile_kernels_of<double>().evidence({tile_work(view, lists, tile, camera, options.compat), known, &target, 1,
                                        pair.data(), scratch.values(evidence_scratch(1))});
  for (std::size_t v = 0; v < view.id.size(); ++v)
    for (std::int64_t slot = lists.slot_begin[v]; slot < lists.slot_begin[v + 1]; ++slot) {
      weight[view.id[v]] += pair[std::size_t(slot) * 4];
      object[view.id[v]] += pair[std::size_t(slot) * 4 + 2];
    }
}

std::vector<std::uint8_t> thresholded(const std::vector<double>& values) {
  std::vector<std::uint8_t> out;
  for (const double x : values) out.push_back(x >= 0.5);
  return out;
}

std::vector<std::uint8_t> double_mask(const DoubleCloud& cloud, const Camera& camera, const SplatOptions& options,
                                      const std::vector<double>& label) {
  ChannelPlan<double> request;
  request.colour = false, request.label = {label.data(), std::int64_t(label.size()), 1};
  SplatEngine<double> engine(tile_kernels_of<double>(), options, cloud.view, camera, request);
  std::vector<double> image(std::size_t(camera.width_px) * std::size_t(camera.height_px)), alpha = image;
  engine.forward({}, {{image.data(), 1}, {alpha.data(), 1}});
  return thresholded(image);
}

std::vector<std::uint8_t> float_mask(const GaussianCloud& cloud, const Camera& camera, const SplatOptions& options,
                                     const std::vector<float>& label) {
  RenderRequest request;
  request.colour = false, request.label = {label.data(), cloud.size(), 1};
  const RenderedView view = render({}, cloud, camera, options, request);
  return thresholded(std::vector<double>(view.label.data.begin(), view.label.data.end()));
}

}  // namespace

TEST_CASE("float labels of a real capture differ from double ones only within rounding of the threshold") {
  if (!fs::exists(kScene / "point_cloud.ply")) return test::skip("no scene bird in ../shared/scenes");
  io::ImportRequest request;
  request.capture.source = kScene.string(), request.masks_dir = (kScene / "masks_sam").string();
  request.hold_out = "every:4:2", request.image_scale = 0.5;
  const Scene scene = io::import_scene(request).scene;
  const io::GaussianPly model = io::read_gaussian_ply(scene.model_path);
  const auto n = std::size_t(model.cloud.size());
  Monitor monitor;
  const SplatOptions options;
  const LabelColumns single = label_gaussians(
      {}, accumulate_evidence({}, monitor, {model.cloud, scene, training_views(scene), options, [&](std::size_t v) {
                                              return io::load_masks(scene, v);
                                            }}))[0];
  const DoubleCloud cloud(model.cloud);
  std::vector<double> weight(n, 0.0), object(n, 0.0), label(n, 0.0);
  for (const std::size_t v : training_views(scene))
    add_double_evidence(cloud, relative_camera(scene.views[v].camera, model.cloud), options, io::load_masks(scene, v),
                        weight, object);
  std::size_t seen = 0, differ = 0, seen_by_one = 0;
  double widest_margin = 0, largest_change = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (weight[i] > 0) label[i] = object[i] / weight[i] > 0.5 ? 1 : 0;
    seen_by_one += (weight[i] > 0) != (single.views[i] > 0);
    if (!(weight[i] > 0) || !(single.views[i] > 0)) continue;
    ++seen;
    const double prob = object[i] / weight[i];
    largest_change = std::max(largest_change, std::abs(prob - double(single.prob[i])));
    if (label[i] == double(single.label[i])) continue;
    ++differ, widest_margin = std::max(widest_margin, std::abs(prob - 0.5));
  }
  double biou[2] = {};
  std::size_t pixels = 0, other_pixels = 0, views = 0;
  for (const SceneView& view : scene.views) {
    if (view.split != Split::kHeldOut) continue;
    ++views;
    Scene truth = scene;
    const auto index = std::size_t(&view - scene.views.data());
    truth.views[index].mask_path = (kScene / "masks_gt" / fs::path(view.camera.name).filename()).string();
    std::vector<std::uint8_t> target;
    const ViewMasks given = io::load_masks(truth, index);
    for (const float m : given.target[0]) target.push_back(m >= 0.5f);
    const std::vector<std::uint8_t> mask[2] = {
        float_mask(model.cloud, view.camera, options, single.label.values()),
        double_mask(cloud, relative_camera(view.camera, model.cloud), options, label)};
    const int w = view.camera.width_px, h = view.camera.height_px;
    for (int k = 0; k < 2; ++k) biou[k] += score_mask({}, {mask[k].data(), w, h}, {target.data(), w, h}).biou_005;
    pixels += target.size();
    for (std::size_t p = 0; p < target.size(); ++p) other_pixels += mask[0][p] != mask[1][p];
  }
  REQUIRE(views > 0);
  MESSAGE("labels that differ: " << differ << " of " << seen << "; seen by one only: " << seen_by_one
                                 << "; largest change of a probability: " << largest_change
                                 << "; widest margin of a label that differs: " << widest_margin);
  MESSAGE("mask pixels that differ: " << other_pixels << " of " << pixels << "; boundary IoU (0.005): float "
                                      << biou[0] / double(views) << ", double " << biou[1] / double(views)
                                      << ", difference " << (biou[0] - biou[1]) / double(views));
  CHECK(double(seen_by_one) < 1e-3 * double(seen));
  CHECK(largest_change < 1e-3);
  CHECK(widest_margin < 1e-3);
  CHECK(double(differ) < 1e-3 * double(seen));
  CHECK(std::abs(biou[0] - biou[1]) / double(views) < 1e-3);
}

}  // namespace ngs
