#include "halves.h"

#include <filesystem>

#include "ngs/io/image/exr.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/make/synth/synth_halves.h"
#include "ngs/ops/image/image_bytes.h"

namespace ngs::cli {
namespace {

namespace fs = std::filesystem;

Scene empty_scene(const SynthData& data) {
  Scene scene;
  scene.objects = {{data.scene.objects[std::size_t(data.scene.target)].name, 0}};
  scene.background = Vec3<double>{0, 0, 0};
  return scene;
}

/// The view's colours before they were composited over black, with its alpha.
ImageU8 cut_out(const synth::SynthView& view) {
  ImageF rgba(view.colour.width_px, view.colour.height_px, 4);
  for (std::size_t i = 0; i < view.coverage.data.size(); ++i) {
    const float alpha = view.coverage.data[i];
    for (std::size_t c = 0; alpha > 0 && c < 3; ++c) rgba.data[4 * i + c] = view.colour.data[3 * i + c] / alpha;
    rgba.data[4 * i + 3] = alpha;
  }
  return to_bytes(rgba);
}

void write_background_view(const std::string& folder, const std::string& name, const synth::SynthView& view,
                           const ImageU8& hole) {
  io::write_png(in_folder(folder + "/images", name), to_bytes(view.colour));
  io::write_png(in_folder(folder + "/masks", name), hole);
  io::ExrImage depth;
  depth.width_px = view.depth.width_px, depth.height_px = view.depth.height_px;
  depth.channels["Z"] = view.depth.data;
  io::write_exr(in_folder(folder + "/depth", fs::path(name).stem().string() + ".exr"), depth);
}

void write_background(Run& run, const std::string& folder, const SynthData& data) {
  const synth::AnalyticScene room = synth::without_target(data.scene);
  std::vector<Camera> cameras = data.cameras;
  cameras.insert(cameras.end(), data.hole_cameras.begin(), data.hole_cameras.end());
  Scene scene = empty_scene(data);
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    if (run.stop_code() != 0) return;
    const bool is_photo = i < data.views.size();
    const ImageU16 label =
        is_photo ? data.views[i].label : synth::render_view(run.exec(), data.scene, cameras[i], 1).label;
    const synth::SynthView view = synth::render_view(run.exec(), room, cameras[i], data.recipe.samples_per_side);
    write_background_view(folder, cameras[i].name, view, binary_mask(label, std::uint32_t(data.scene.target) + 1));
    scene.views.push_back({cameras[i], folder + "/images/" + cameras[i].name, folder + "/masks/" + cameras[i].name,
                           is_photo ? Split::kTrain : Split::kHeldOut});
  }
  io::write_scene_json(folder + "/scene.json", scene);
}

void write_object(Run& run, const std::string& folder, const SynthData& data) {
  const synth::AnalyticScene target = synth::target_alone(data.scene);
  Scene scene = empty_scene(data);
  scene.mask_mode = MaskMode::kSoft;
  for (const Camera& camera : synth::target_rig(data.recipe, data.scene)) {
    if (run.stop_code() != 0) return;
    const std::string path = in_folder(folder + "/images", camera.name);
    io::write_png(path, cut_out(synth::render_view(run.exec(), target, camera, data.recipe.samples_per_side)));
    scene.views.push_back({camera, path, path, Split::kHeldOut});
  }
  io::write_scene_json(folder + "/scene.json", scene);
}

}  // namespace

std::size_t views_of_halves(const SynthData& data) {
  if (data.hole_cameras.empty()) return 0;
  return data.cameras.size() + data.hole_cameras.size() + synth::kTargetViews;
}

void write_halves(Run& run, const std::string& folder, const SynthData& data) {
  const auto timed = run.monitor().scope("halves");
  write_background(run, folder + "/background", data);
  write_object(run, folder + "/object", data);
}

}  // namespace ngs::cli
