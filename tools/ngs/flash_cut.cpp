#include "flash_cut.h"

#include <filesystem>
#include <limits>

#include "ngs/edit/select/view_agreement.h"
#include "ngs/interactive/ball_cut.h"
#include "ngs/io/formats/write_splat.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/orbit/orbit_stage.h"
#include "ngs/render/render_options.h"
#include "ngs/scene/mask_threshold.h"
#include "ngs/scene/view_names.h"
#include "shared/scene/prompt_input.h"
#include "shared/scene/scene_model.h"

namespace ngs::ngs_tool {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxViews = 32;

}  // namespace

void render_masks_from_labels(cli::Run& run, const GaussianCloud& cloud, FlashCut& cut) {
  const std::vector<float> label = cut.labels.label.values();
  const RenderRequest request{.colour = false, .label = {label.data(), cloud.size(), 1}};
  run.on_device_or_cpu([&] {
    const SplatOptions splat = prepared_for(run.exec(), splat_options({}, cloud, cut.scene), cloud);
    for (std::size_t v = 0; v < cut.masks.size(); ++v) {
      const RenderedView view = render(run.exec(), cloud, cut.cameras[v], splat, request);
      for (std::size_t p = 0; p < cut.masks[v].size(); ++p) cut.masks[v][p] = label_is_foreground(view.label.data[p]);
    }
  });
}

double agreement_in_views(cli::Run& run, const GaussianCloud& cloud, const std::vector<float>& label,
                          const FlashCut& cut, const std::vector<PixelMask>& masks) {
  return run.on_device_or_cpu([&] {
    const SplatOptions splat = prepared_for(run.exec(), splat_options({}, cloud, cut.scene), cloud);
    return view_agreement(run.exec(), {cloud, label, splat}, cut.cameras, masks);
  });
}

void write_flash_masks(const std::string& folder, const FlashCut& cut) {
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  fs::create_directories(folder);
  const std::vector<std::string> names = output_names(cut.scene.views);
  for (std::size_t v = 0; v < names.size(); ++v) {
    ImageU8 mask(cut.cameras[v].width_px, cut.cameras[v].height_px, 1);
    for (std::size_t p = 0; p < mask.data.size(); ++p) mask.data[p] = cut.masks[v][p] ? 255 : 0;
    io::write_png(folder + "/" + names[v] + ".png", mask);
  }
}

void write_flash_models(cli::Run& run, const std::string& folder, const io::GaussianPly& ply,
                        const LabelColumns& labels) {
  std::vector<std::uint8_t> keep(labels.label.begin(), labels.label.end()), rest(keep.size());
  for (std::size_t i = 0; i < keep.size(); ++i) rest[i] = !keep[i];
  for (const std::string& note : io::write_splat(folder + "/object.ply", {ply, keep})) run.monitor().warn(note);
  for (const std::string& note : io::write_splat(folder + "/background.ply", {ply, rest})) run.monitor().warn(note);
  const std::vector<io::NamedLabels> objects{{"object", labels}};
  const std::vector<float> fixed(keep.size(), 1);  // ngs-extract would vote again about Gaussians that no view sees
  io::write_labelled_ply(folder + "/labelled.ply", ply, objects, {.fixed = fixed});
}

void keep_boundary_labels(const std::string& path, const LabelColumns& first) {
  const io::GaussianPly ply = io::read_gaussian_ply(path);
  if (ply.labels.label.size() != first.label.size()) return;
  std::vector<io::NamedLabels> objects{{ply.object, ply.labels}};
  io::write_labelled_ply(path, ply, objects, {.fixed = fix_boundary(first, objects[0].columns)});
}

std::vector<PixelMask> read_flash_masks(const std::string& folder, const FlashCut& cut) {
  const std::vector<std::string> names = output_names(cut.scene.views);
  std::vector<PixelMask> masks(names.size());
  for (std::size_t v = 0; v < names.size(); ++v) {
    const std::string path = folder + "/" + names[v] + ".png";
    std::error_code unreadable;
    if (!fs::exists(path, unreadable)) continue;
    const io::RawMask raw = io::read_mask_raw(path, io::Palette::kMask);
    const Camera& camera = cut.cameras[v];
    if (raw.width_px != camera.width_px || raw.height_px != camera.height_px || raw.channels != 1) continue;
    for (const auto value : raw.data) masks[v].push_back(std::uint8_t(value >= kMaskThreshold));
  }
  return masks;
}

std::string max_views(const CutOptions& options) {
  if (options.view_count > 0) return std::to_string(options.view_count);
  return options.method == CutMethod::kFlash ? std::to_string(kMaxViews) : "";
}

std::optional<FlashCut> flash_cut(cli::Run& run, const io::GaussianPly& ply, const FlashInputs& in) {
  Monitor& monitor = run.monitor();
  FlashCut out;
  out.scene = io::read_scene_json(in.scene);
  orbit::Ball ball{{0, 0, 0}, std::numeric_limits<double>::infinity()};
  if (!in.around.empty()) ball = orbit::parse_ball(in.around);
  live::BallCutInput input{ply.cloud, ball, out.scene, splat_options({}, ply.cloud, out.scene),
                           cli::read_prompts(run, out.scene, in.view, in.strokes)};
  input.all_pieces = in.all_pieces;
  if (in.longer_side_px > 0) input.longer_side_px = in.longer_side_px;
  run.needs_device_memory(cli::device_bytes(double(ply.cloud.size()), ply.cloud.rest_count()));
  live::BallCut cut = run.on_device_or_cpu([&] { return live::cut_in_ball(run.exec(), monitor, input); });
  if (monitor.stop_requested()) return std::nullopt;
  out.labels = std::move(cut.labels);
  out.cameras = std::move(cut.cameras);
  out.is_expected = cut.is_expected;
  out.figures = {cut.object, ply.cloud.size() - cut.object, cut.in_ball, cut.removed, cut.needles, cut.views.size(), 0,
                 0};
  for (SpreadView& view : cut.views) {
    const bool segmented = view.source == MaskSource::kReference || view.source == MaskSource::kSegmented;
    out.figures.segmented += segmented;
    out.segmented.push_back(segmented ? view.mask : PixelMask());
    out.masks.push_back(std::move(view.mask));
  }
  return out;
}

}  // namespace ngs::ngs_tool
