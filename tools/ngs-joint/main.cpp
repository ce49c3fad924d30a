// ngs-joint: scene.json + labelled PLY -> labelled PLY with optimised labels and attributes. Algorithm 1,
// step 6.
#include "methods.h"
#include "ngs/io/content_hash.h"
#include "ngs/io/gaussian_ply.h"
#include "ngs/io/masks.h"
#include "ngs/io/photo.h"
#include "ngs/io/query_ply.h"
#include "ngs/io/scene_json.h"
#include "ngs/stages/render_options.h"
#include "ngs/stages/render_stage.h"
#include "ngs/stages/variance_stage.h"
#include "optimise.h"
#include "prepare.h"

int main(int argc, char** argv) {
  using namespace ngs;
  cli::Tool tool("ngs-joint",
                 "Optimise labels, Gaussians and a NeRF on the boundary jointly (Eqs. 1-2, 10-20), or run a "
                 "method beside it.",
                 {"ngs-joint scene.json boundary.ply --field field.ply -o labelled.ply",
                  "ngs-joint scene.json boundary.ply --method flash -o labelled.ply"});
  joint::Settings settings;
  RasterOptions raster;
  joint::MethodOptions methods;
  tool.options(settings.run);
  tool.options(settings.joint);
  tool.options(settings.edge);
  tool.options(settings.sample);
  tool.options(settings.rbf);
  tool.options(raster);
  methods.declare(tool);
  const cli::Input& scene_json = tool.input("scene", "scene.json written by ngs-scene");
  const cli::Input& boundary = tool.input("boundary", "PLY written by ngs-variance");
  const cli::Input& field =
      tool.optional_input("--field", "PLY written by ngs-rbf; else sampled and interpolated here");
  const cli::Output& out = tool.output("-o,--output", "labelled PLY with optimised attributes");
  const cli::Output& nerf = tool.optional_output("--nerf", "parameters of the field (safetensors)");
  const cli::Output& trace =
      tool.optional_output("--trace", "one JSON line per evaluation: time, loss terms, agreement");
  tool.stops_on_request();

  return tool.run(argc, argv, [&](cli::Run& run) {
    if (settings.run.resume && settings.run.checkpoint.empty())
      throw Error(ErrorCode::kUsage, "--resume without --checkpoint, expected the folder to go on from",
                  "--checkpoint DIR");
    const Scene scene = with_objects(io::read_scene_json(scene_json.path), settings.run.objects);
    const io::GaussianPly ply = io::read_gaussian_ply(boundary.path);
    MethodInput read{.cloud = ply.cloud,
                     .scene = scene,
                     .views = training_views(scene),
                     .load_masks = [&](std::size_t view) { return io::load_masks(scene, view); },
                     .load_photo = [&](std::size_t view) { return io::load_photo(scene, view); },
                     .splat = splat_options(raster, ply.cloud, scene),
                     .background = parse_background(settings.run.background),
                     .seed = run.seed(),
                     .fixed = ply.fixed,
                     .labels = joint::labels_of(ply, scene),
                     .load_fine_photo = [&](std::size_t view) { return io::load_fine_photo(scene, view); }};
    if (settings.run.explain || run.dry_run()) {
      run.plan({{"effects", joint::explain(settings.joint)},
                {"training_views", read.views.size()},
                {"gaussians", ply.cloud.size()}});
      return 0;
    }
    const ViewTrust trust =
        joint::wanted(settings, &JointEffects::view_trust) ? joint::handle_trust(run, read) : ViewTrust{};
    const MethodInput believed = joint::with_trusted_masks(run, read, trust);
    const bool draft = settings.joint.quality == Quality::kDraft;
    const joint::FloaterOutcome clean = joint::wanted(settings, &JointEffects::floaters)
                                            ? joint::handle_floaters(run, believed, draft)
                                            : joint::FloaterOutcome{};
    const MethodInput input = joint::without_floaters(believed, clean);
    if (settings.run.method != joint::Method::kPaper) {
      if (trace || nerf || field || !settings.run.time_budget.empty() || !settings.run.target.empty() ||
          !settings.run.checkpoint.empty())
        run.monitor().warn(
            "--field, --nerf, --trace, --time-budget, --target and --checkpoint belong to --method paper; "
            "this "
            "method does not use them");
      joint::write_result(run, {ply, scene, clean.floater},
                          joint::run_beside(run, settings.run.method, methods, input), out.path);
      return 0;
    }
    std::optional<QueryField> given;
    if (field && !clean.removed()) given = io::read_query_ply(field.path);
    const std::string fingerprint = io::content_hash(boundary.path).xxh3 + " " +
                                    joint::options_text(settings) + " seed " + std::to_string(run.seed());
    return joint::optimise(run, settings,
                           {input,
                            given ? &*given : nullptr,
                            {ply, scene, clean.floater},
                            {settings.run.checkpoint, fingerprint}},
                           {out.path, nerf.path, trace.path});
  });
}
