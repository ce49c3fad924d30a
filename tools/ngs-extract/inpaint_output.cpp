#include "inpaint_output.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <set>

#include "ngs/io/capture/sparse_points.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/image/masks.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/ops/image/image_bytes.h"
#include "ngs/render/render_options.h"
#include "ngs/scene/view_names.h"
#include "shared/scene/scene_model.h"

namespace ngs::cli {
namespace {

constexpr const char* kPictures[] = {"images", "holes", "dilated"};
constexpr const char* kOtherFiles[] = {"background.ply", "sparse/0/cameras.txt", "sparse/0/images.txt",
                                       "sparse/0/points3D.txt"};

ImageU8 picture_of(const PixelMask& mask, const Camera& camera) {
  ImageU8 out(camera.width_px, camera.height_px, 1);
  for (std::size_t p = 0; p < mask.size(); ++p) out.data[p] = mask[p] ? 255 : 0;
  return out;
}

/// The file of a view, relative to the folder.
std::string picture_file(const std::string& folder, const char* kind, const std::string& name) {
  return folder + "/" + kind + "/" + name + ".png";
}

/// Throws kUsage if one of `files` is an input. Absent inputs (optional ones, views without a mask) are empty.
void refuse_over_inputs(const std::vector<std::string>& inputs, const std::vector<std::string>& files) {
  std::error_code ignored;
  std::set<std::filesystem::path> kept;
  for (const std::string& input : inputs)
    if (!input.empty()) kept.insert(std::filesystem::weakly_canonical(input, ignored));
  for (const std::string& file : files)
    if (kept.contains(std::filesystem::weakly_canonical(file, ignored)))
      throw Error(ErrorCode::kUsage, file + ": is an input of this run, which would replace it",
                  "choose another folder for --inpaint");
}

}  // namespace

void check_inpaint_options(Run& run, const Output& inpaint, const Input& inpainted, const Input& scene) {
  if (inpaint && !scene) throw Error(ErrorCode::kUsage, "--inpaint needs the cameras", "give --scene scene.json");
  if (!inpaint && !inpainted) run.warn_unused({"--inpaint-dilate-px"}, "without --inpaint or --inpainted");
}

void check_inpaint_folder(const Scene& scene, const std::string& scene_path, const std::string& folder,
                          std::vector<std::string> inputs) {
  std::error_code ignored;
  if (std::filesystem::equivalent(folder + "/scene.json", scene_path, ignored))
    throw Error(ErrorCode::kUsage, folder + ": is the folder of the scene, whose files would be replaced",
                "choose another folder for --inpaint");
  std::vector<std::string> files;
  for (const char* name : kOtherFiles) files.push_back(folder + "/" + name);
  for (const std::string& name : output_names(scene.views))
    for (const char* kind : kPictures) files.push_back(picture_file(folder, kind, name));
  refuse_over_photos(scene, files);
  inputs.push_back(scene.model_path);
  for (std::size_t view = 0; view < scene.views.size(); ++view)
    std::ranges::copy(io::mask_files(scene, view), std::back_inserter(inputs));
  refuse_over_inputs(inputs, files);
}

void write_inpainting(Run& run, const Extractor& extractor, const InpaintOptions& options, const Scene& scene,
                      const std::string& folder) {
  std::filesystem::create_directories(folder + "/sparse/0");
  const GaussianCloud& cloud = extractor.cloud();
  const SplatOptions splat = splat_options({}, cloud, scene);
  const std::vector<std::uint8_t> seen = seen_gaussians(run.exec(), run.monitor(), cloud, scene, splat);
  Scene handed = scene;
  handed.model_path = folder + "/background.ply";
  handed.objects = {{"hole", 0}};
  handed.image_scale = 1;  // its photos are renders, which have the cameras' size
  handed.use_binary_masks();
  handed.void_id.reset(),
      handed.missing_mask = MissingMask::kUnknown;  // settings of label maps do not apply; every view has a hole mask
  std::vector<Camera> cameras;
  Json views = Json::array();
  const std::vector<std::string> names = output_names(scene.views);
  for (SceneView& view : handed.views) {
    const auto timed = run.monitor().scope("holes");
    const ViewHole found =
        find_hole(run.exec(), options, {cloud, extractor.object(), seen, background_of(scene)}, view.camera, splat);
    const std::string& name = names[cameras.size()];
    for (const char* kind : kPictures)
      std::filesystem::create_directories(std::filesystem::path(picture_file(folder, kind, name)).parent_path());
    view.image_path = picture_file(folder, "images", name), view.mask_path = picture_file(folder, "dilated", name);
    io::write_png(view.image_path, to_bytes(found.colour));
    io::write_png(picture_file(folder, "holes", name), picture_of(found.hole, view.camera));
    io::write_png(view.mask_path, picture_of(found.dilated, view.camera));
    views.push_back({{"name", view.camera.name}, {"hole_pixels", std::count(found.hole.begin(), found.hole.end(), 1)}});
    cameras.push_back(view.camera);
    cameras.back().name = name + ".png";
    run.monitor().progress(std::int64_t(cameras.size()), std::int64_t(handed.views.size()));
  }
  extractor.write_background(handed.model_path);
  io::write_colmap_text(folder + "/sparse/0", cameras, {});
  io::write_scene_json(folder + "/scene.json", handed);
  run.result()["inpaint"] = {{"never_seen", std::count(seen.begin(), seen.end(), 0)}, {"views", views}};
}

}  // namespace ngs::cli
