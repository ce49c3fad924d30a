#include "group_scene.h"

#include "group_output.h"
#include "mask_views.h"
#include "ngs/cut/groups/room_surfaces.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/problem/view_list.h"
#include "shared/scene/scene_model.h"
#include "shared/tool.h"

namespace ngs::group {
namespace {

/// A Gaussian counts in a view if its visibility there is at least this share of its largest.
constexpr double kUnhidden = 0.3;

Json plan_of(const GaussianCloud& cloud, const Scene& scene, std::size_t views) {
  constexpr double kSeenShare = 0.4, kPlanes = 64;
  const double seen = kSeenShare * double(cloud.size()) * double(views) * sizeof(MaskedGaussian);
  const double bytes = double(cloud.size()) * (cli::model_bytes(cloud) + cli::kPreparedBytes) + seen +
                       cli::largest_view_px(scene) * 4 * kPlanes;
  return {{"views", views}, {"memory_mib", cli::peak_mib(bytes)}};
}

void report(cli::Run& run, const GroupedObjects& found, const std::vector<ViewGaussians>& of_view) {
  std::size_t masks = 0;
  for (const ViewGaussians& view : of_view) masks += std::size_t(view.masks);
  run.result()["masks"] = masks;
  run.result()["objects"] = found.sure;
  run.result()["doubtful"] = found.objects.size() - found.sure;
  std::string lines = "object  Gaussians  views  confidence\n";
  for (std::size_t k = 0; k < found.sure; ++k) {
    const GroupedObject& object = found.objects[k];
    char line[80];
    std::snprintf(line, sizeof line, "%-6s %10lld %6zu %11.2f\n", object_name(k).c_str(),
                  static_cast<long long>(object.gaussians), object.views.size(), object.confidence);
    lines += line;
  }
  run.text(lines);
}

/// The scene with the masks to read; without masks it has none.
Scene scene_with_masks(cli::Run& run, const Options& options, const std::string& path, const std::string& masks) {
  if (!options.source.without_masks) return with_masks_of(run, cli::read_scene(run, path), path, masks);
  if (!masks.empty())
    throw Error(ErrorCode::kUsage, "--masks and --without-masks are both given, expected one of them");
  run.warn_unused({"--visible", "--contained", "--consensus", "--split", "--min-observers"}, "without masks");
  Scene scene = cli::read_scene(run, path);
  for (SceneView& view : scene.views) view.mask_path.clear();
  scene.mask_mode = MaskMode::kLabel;
  return scene;
}

}  // namespace

int group_scene(cli::Run& run, const Options& options, const std::string& scene_path, const std::string& masks,
                const std::string& folder) {
  const Scene scene = scene_with_masks(run, options, scene_path, masks);
  cli::require_model(run, scene, scene_path);
  refuse_over_inputs(scene, folder);
  const io::GaussianPly ply = io::read_gaussian_ply(scene.model_path, {io::HigherBands::kCheckOnly});
  const std::vector<std::size_t> views = training_views(scene);
  run.result()["views"] = views.size();
  if (run.dry_run()) return run.plan(plan_of(ply.cloud, scene, views.size())), cli::kDone;
  const SplatOptions splat = prepared_for(run.exec(), splat_options(options.raster, ply.cloud, scene), ply.cloud);
  std::vector<NumberedMasks> parts;  // [views] without masks
  if (options.source.without_masks) parts = masks_of_surface(run, scene, views, ply, splat);
  if (run.stop_code() != 0) return run.stop_code();
  std::vector<ViewGaussians> of_view(views.size());
  {
    const auto timed = run.monitor().scope("evidence");
    const bool complete = for_each_view(&run.monitor(), views, [&](std::size_t n, std::size_t v) {
      const Camera& camera = scene.views[v].camera;
      of_view[n] = view_gaussians(run.exec(), ply.cloud, camera, splat,
                                  at_size_of(camera, parts.empty() ? read_masks(scene, v) : parts[n]));
    });
    if (!complete) return run.stop_code();
  }
  keep_unhidden(run.exec(), std::size_t(ply.cloud.size()), kUnhidden, of_view);
  const GroupedObjects found = [&] {
    const auto timed = run.monitor().scope("groups");
    const MaskGroups groups = parts.empty() ? group_masks(run.exec(), options.groups, of_view) : same_numbers(parts);
    GroupedObjects objects =
        objects_of_groups(run.exec(), options.objects, std::size_t(ply.cloud.size()), of_view, groups);
    run.result()["room_surfaces"] = remove_room_surfaces(ply.cloud, up_of(ply), objects);
    return objects;
  }();
  report(run, found, of_view);
  if (found.sure == 0) {
    run.nothing_found(scene_path + ": no object in " + std::to_string(views.size()) + " views" +
                          (parts.empty() ? " of masks" : "") + ", expected at least one that several views show alike",
                      parts.empty() ? "look at the masks; fewer views must agree with --min-views 2 --min-observers 1"
                                    : "give masks of everything: ngs-mask --everything, then --masks DIR");
    return cli::kDone;
  }
  const bool complete = write_groups(run, {scene, ply, splat, views, of_view, found, !parts.empty()}, folder,
                                     run.comes_from_stream(scene_path) ? "" : io::truth_of_scene_json(scene_path));
  return complete ? int(cli::kDone) : run.stop_code();
}

}  // namespace ngs::group
