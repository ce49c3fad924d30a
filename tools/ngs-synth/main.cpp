// ngs-synth: generates photos, poses, exact and erroneous masks, depth, and a fitted splat from a recipe.
#include "dataset.h"
#include "shared/tool.h"

namespace {

using namespace ngs;

synth::Recipe resolved(synth::Recipe recipe, const cli::SynthOptions& o) {
  if (o.view_count > 0) recipe.views = o.view_count;
  const auto side_of = [](int px, int recipe_px) {
    if (px > 0 && px < 8)
      throw Error(ErrorCode::kUsage, "image side of " + std::to_string(px) + " px, expected 0 or at least 8");
    return px > 0 ? px : recipe_px;
  };
  recipe.width_px = side_of(o.width_px, recipe.width_px);
  recipe.height_px = side_of(o.height_px, recipe.height_px);
  if (o.scene_seed >= 0) recipe.scene_seed = o.scene_seed;
  if (o.objects > 0) recipe.objects = o.objects;
  if (!o.target.empty()) recipe.target = o.target;
  recipe.grey |= o.grey;
  recipe.cast_shadows |= o.cast_shadows;
  return recipe;
}

/// Estimated wall time in seconds and memory in MiB; 4e-7 s per ray on one core.
Json estimate(const cli::SynthData& data, const cli::SynthOptions& options, const FitOptions& fit, int threads) {
  double pixels = 0;
  for (const Camera& c : data.cameras) pixels += double(c.width_px) * c.height_px;
  const double all_per_photo = 1 + double(cli::views_of_halves(data)) / double(data.cameras.size());
  const double rays = pixels * (1 + data.recipe.samples_per_side * data.recipe.samples_per_side);
  const FitCost cost = options.fit ? fit_cost(fit, data.cameras, 3 * sizeof(float) * pixels) : FitCost{};
  return {{"time_s", (4e-7 * rays * all_per_photo + cost.cpu_s) / threads},
          {"memory_mib", 40 + 2e-6 * rays + cost.memory_mib}};
}

}  // namespace

int main(int argc, char** argv) {
  cli::Tool tool(
      "ngs-synth", "Generate an analytic scene with exact masks and fit a splat to it.",
      {"ngs-synth torus-box -o scene/", "ngs-synth leaves -o noisy/ --mask-noise jitter:1.5,drop:0.1 --fit-steps 3000",
       "ngs-synth recipe.json -o again/ --no-fit", "ngs-synth corner -o corner/ --truth halves",
       "ngs-synth messy -o messy/ --objects 100 --masks everything"});
  cli::SynthOptions options;
  FitOptions fit_options = cli::small_fit();
  tool.options(options);
  tool.options(fit_options, {.name = "fit",
                             .about = "options of the fit to the photos",
                             .prefix = "fit_",
                             .applies = [&options] { return options.fit; },
                             .needs = "--fit"});
  const cli::Argument& name = tool.argument("recipe",
                                            "two-spheres, torus-box, leaves, bones, table, corner, ground, turntable, "
                                            "messy, tiny, or a JSON file of recipe options");
  const cli::Output& out = tool.output_dir("-o,--output", "folder of the scene");
  tool.stops_on_request();

  return tool.run(argc, argv, [&](cli::Run& run) {
    bool is_file = false;
    cli::SynthData data;
    data.recipe = resolved(cli::load_recipe(name.value, is_file), options);
    if (is_file) run.add_input("recipe", name.value);
    cli::build(data, options.truth == cli::Truth::kHalves);
    const bool everything = options.masks == cli::Masks::kEverything;
    const auto noise_of = everything ? synth::NoiseOf::kEverything : synth::NoiseOf::kLabelMaps;
    const cli::MaskErrors errors{options.mask_noise, synth::parse_mask_noise(options.mask_noise, noise_of), run.seed(),
                                 everything};
    if (data.recipe.scene == synth::SceneKind::kMessy)
      cli::make_finer(fit_options, data.recipe);
    else
      run.warn_unused({"--objects"}, "without the recipe messy");
    run.result()["views"] = data.cameras.size();
    run.result()["objects"] = synth::object_count(data.scene);
    run.result()["target"] = data.scene.objects[std::size_t(data.scene.target)].name;
    if (run.dry_run()) return run.plan(estimate(data, options, fit_options, run.exec().threads)), cli::kDone;

    for (std::size_t i = 0; i < data.cameras.size() && run.stop_code() == 0; ++i) {
      const auto timed = run.monitor().scope("render");
      data.views.push_back(synth::render_view(run.exec(), data.scene, data.cameras[i], data.recipe.samples_per_side));
      cli::write_view(run.exec(), out.path, data, i, errors);
      run.monitor().progress(std::int64_t(i) + 1, std::int64_t(data.cameras.size()));
    }
    if (run.stop_code() != 0) return run.stop_code();
    data.points =
        synth::sample_points(data.cameras, data.views, data.recipe.points, std::uint64_t(data.recipe.scene_seed));
    cli::write_description(out.path, data, errors);
    if (!data.hole_cameras.empty()) cli::write_halves(run, out.path + "/halves", data);
    if (options.fit && run.stop_code() == 0) cli::fit_splat(run, data, fit_options, out.path + "/point_cloud.ply");
    return run.stop_code();
  });
}
