// ngs-group: masks of everything, whose ids mean nothing in other views -> label maps with one id per object.
#include "group_output.h"
#include "mask_views.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/problem/view_list.h"
#include "ngs/render/render_options.h"
#include "shared/scene/memory_model.h"
#include "shared/scene/scene_model.h"
#include "shared/tool.h"

namespace {

using namespace ngs;

struct Options {
  GroupOptions groups;
  ObjectOptions objects;
  RasterOptions raster;
};

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
    std::snprintf(line, sizeof line, "%-6s %10lld %6zu %11.2f\n", group::object_name(k).c_str(),
                  static_cast<long long>(object.gaussians), object.views.size(), object.confidence);
    lines += line;
  }
  run.text(lines);
}

int group_scene(cli::Run& run, const Options& options, const std::string& scene_path, const std::string& masks,
                const cli::Output& out) {
  const Scene scene = group::with_masks_of(run, cli::read_scene(run, scene_path), scene_path, masks);
  cli::require_model(run, scene, scene_path);
  group::refuse_over_inputs(scene, out.path);
  const io::GaussianPly ply = io::read_gaussian_ply(scene.model_path, {io::HigherBands::kCheckOnly});
  const std::vector<std::size_t> views = training_views(scene);
  run.result()["views"] = views.size();
  if (run.dry_run()) return run.plan(plan_of(ply.cloud, scene, views.size())), cli::kDone;
  const SplatOptions splat = prepared_for(run.exec(), splat_options(options.raster, ply.cloud, scene), ply.cloud);
  std::vector<ViewGaussians> of_view(views.size());
  {
    const auto timed = run.monitor().scope("evidence");
    const bool complete = for_each_view(&run.monitor(), views, [&](std::size_t n, std::size_t v) {
      const Camera& camera = scene.views[v].camera;
      of_view[n] =
          view_gaussians(run.exec(), ply.cloud, camera, splat, group::at_size_of(camera, group::read_masks(scene, v)));
    });
    if (!complete) return run.stop_code();
  }
  keep_unhidden(run.exec(), std::size_t(ply.cloud.size()), kUnhidden, of_view);
  const GroupedObjects found = [&] {
    const auto timed = run.monitor().scope("groups");
    const MaskGroups groups = group_masks(run.exec(), options.groups, of_view);
    return objects_of_groups(run.exec(), options.objects, std::size_t(ply.cloud.size()), of_view, groups);
  }();
  report(run, found, of_view);
  if (found.sure == 0) {
    run.nothing_found(scene_path + ": no object in " + std::to_string(views.size()) +
                          " views of masks, expected at least one that several views show alike",
                      "look at the masks; fewer views must agree with --min-views 2 --min-observers 1");
    return cli::kDone;
  }
  const bool complete =
      group::write_groups(run, {scene, ply, splat, views, of_view, found}, out.path,
                          run.comes_from_stream(scene_path) ? "" : io::truth_of_scene_json(scene_path));
  return complete ? int(cli::kDone) : run.stop_code();
}

}  // namespace

int main(int argc, char** argv) {
  cli::Tool tool("ngs-group", "Find the objects in masks of everything, whose ids mean nothing in other views.",
                 {"ngs-group scene.json --masks masks_all/ -o grouped/", "ngs-group scene.json -o grouped/"});
  Options options;
  tool.options(options.groups);
  tool.options(options.objects);
  tool.options(options.raster);
  const cli::Input& scene = tool.input("scene", "scene.json written by ngs-scene");
  const cli::Input& masks = tool.optional_input(
      "--masks", "folder of label maps, one per view, 8 or 16 bit; default: the label maps of the scene");
  const cli::Output& out = tool.output_dir("-o,--output", "folder for masks/, scene.json and objects.json");
  tool.stops_on_request();
  return tool.run(argc, argv, [&](cli::Run& run) { return group_scene(run, options, scene.path, masks.path, out); });
}
