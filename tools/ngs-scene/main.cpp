// ngs-scene: cameras, photos, masks and a model of any format -> a checked scene.json.
#include "check_report.h"
#include "check_run.h"
#include "commands.h"
#include "ngs/core/error.h"
#include "ngs/io/capture/transforms_json.h"
#include "ngs/io/files/shell_word.h"
#include "ngs/io/scene/find_model.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/render/background.h"
#include "shared/cli/dispatch.h"
#include "shared/scene/import_options.h"
#include "shared/scene/scene_model.h"
#include "shared/tool.h"

namespace {

using namespace ngs;

int write_scene(const cli::Run& run, const cli::Output& out, const io::ImportedScene& imported) {
  io::write_scene_json(out.path, imported.scene,
                       run.goes_to_stdout(out) ? io::StoredPaths::kAbsolute : io::StoredPaths::kRelative,
                       imported.truth_dir);
  return cli::kDone;
}

/// nerfstudio's transform below the folder of the capture.
SceneCheckOptions::WorldFile world_file(const std::string& folder) {
  const std::string path = io::find_world_transform(folder);
  if (path.empty()) return {};
  try {
    return {io::shell_word(path), [world = io::read_world_transform(path)](Camera camera) {
              io::apply(world, camera);
              return camera;
            }};
  } catch (const Error&) {
    return {};  // of another program
  }
}

int import_command(int argc, char** argv) {
  cli::Tool tool("ngs-scene import",
                 "Import cameras, photos, masks and a model of any format, and check that they fit together.",
                 {"ngs-scene import captures/garden --ply garden.ply --masks garden/masks -o scene.json",
                  "ngs-scene import transforms.json --ply splat.ply --hold-out every:8:0 --image-scale 0.5 -o "
                  "scene.json"});
  cli::ImportOptions options;
  SceneCheckOptions checks;
  tool.options(options);
  tool.options(checks);
  const cli::Argument& source = tool.argument(
      "source", "COLMAP folder, transforms.json, cameras.json, poses_bounds.npy, or a folder with one of them");
  const cli::Input& ply = tool.optional_input(
      "--ply",
      "3DGS model (.ply, .spz, .sog, .splat, .ksplat, .glb); default: point_cloud.ply or model.ply next to the cameras",
      "--model");
  const cli::Input& images = tool.optional_input("--images", "folder of photos; default: images/ next to the cameras");
  const cli::Input& masks =
      tool.optional_input("--masks", "folder of masks; default: masks/ or masks_sam/ next to the cameras");
  const cli::Input& truth = tool.optional_input(
      "--truth", "folder of true masks, used only by ngs-eval; default: masks_gt/ or gt/ next to the cameras", "--gt");
  const cli::Input& world = tool.optional_input(
      "--world-transform", "JSON {transform, scale} from cameras to model (nerfstudio's dataparser_transforms.json)");
  const cli::Output& out = tool.output("-o,--output", "scene.json");

  return tool.run(argc, argv, [&](cli::Run& run) {
    if (options.mask_mode != MaskMode::kBinary) run.warn_unused({"--mask-threshold"}, "without --mask-mode binary");
    io::ImportedScene imported = [&] {
      const auto timed = run.monitor().scope("import");
      return io::import_scene(
          cli::request_from(options, source.value, {ply.path, images.path, masks.path, truth.path, world.path}));
    }();
    if (imported.format != "transforms.json") run.warn_unused({"--original-world"}, "without transforms.json");
    run.add_input("cameras", imported.cameras_file);
    if (!masks && !imported.masks_dir.empty()) run.add_input("masks", imported.masks_dir);
    run.result() = scene_tool::import_json(imported);
    if (run.dry_run()) {
      run.plan({{"views", imported.scene.views.size()}, {"compared_views", checks.check_views}});
      return cli::kDone;
    }
    if (imported.scene.renders) {
      scene_tool::check_renders(run, checks, imported);
      return write_scene(run, out, imported);
    }
    checks.world_transform = [&source] { return world_file(io::capture_folder(source.value)); };
    scene_tool::SceneChecks scene(run, checks, imported.scene, std::move(imported.notes));
    if (options.compat == CompatChoice::kGsplat) imported.scene.compat = Compat::kGsplat;
    if (options.antialias != Antialias::kAuto) imported.scene.antialiased = options.antialias == Antialias::kOn;
    choose_background(options.background, run.monitor(), imported.scene);
    scene.validate_alpha_masks();
    const bool has_background = !options.background.empty() || scene.choose_background_of_transparent_photos();
    scene.check(options.compat == CompatChoice::kAuto);
    scene.leave_out_lost_masks();
    scene.find_filter(options.filter_px2);
    if (options.align_views) scene.align_views(!has_background);
    if (!has_background) scene.find_background();
    scene.drop_emptied_photos();
    return write_scene(run, out, imported);
  });
}

}  // namespace

int main(int argc, char** argv) {
  return ngs::cli::dispatch(
      argc, argv,
      {{"import", import_command, "cameras, photos, masks, model -> scene.json"},
       {"orbit", ngs::scene_tool::orbit_command, "a model without photos -> cameras, renders, scene.json"},
       {"check", ngs::scene_tool::check_command, "repeat the checks of a scene.json"},
       {"undistort", ngs::scene_tool::undistort_command, "photos and masks with lens distortion -> pinhole"},
       {"degrade", ngs::scene_tool::degrade_command, "masks -> masks with errors of known size"}});
}
