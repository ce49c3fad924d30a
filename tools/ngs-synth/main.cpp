// ngs-synth: generates photos, poses, exact and erroneous masks, depth, and a fitted splat from a recipe.
#include "dataset.h"
#include "halves.h"
#include "ngs/io/ply/gaussian_ply.h"
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
  recipe.width_px = side_of(o.width_px, recipe.width_px), recipe.height_px = side_of(o.height_px, recipe.height_px);
  if (o.scene_seed >= 0) recipe.scene_seed = o.scene_seed;
  if (!o.target.empty()) recipe.target = o.target;
  recipe.grey |= o.grey, recipe.cast_shadows |= o.cast_shadows;
  return recipe;
}

FitOptions small_fit() {
  FitOptions options;
  options.steps = 1500, options.sh_degree = 1, options.max_gaussians = 8000;
  options.near_loss = 0;  // initial points are on the surfaces, and measured tables refer to these splats
  return options;
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

void fit(cli::Run& run, const cli::SynthData& data, const FitOptions& options, const std::string& path) {
  const std::vector<FitView> views = cli::fit_views(data);
  Fitter fitter(options, views, initial_fit(run.exec(), options, cli::fit_points(data.points), views, run.seed()),
                run.seed());
  const double start = wall_seconds();
  run_fit(run.exec(), run.monitor(), fitter, options, {});
  const double seconds = wall_seconds() - start;
  if (run.stop_code() != 0) return;
  const GaussianCloud& cloud = fitter.state().cloud;
  const FitScore score = score_fit(run.exec(), options, cloud, views, Split::kTrain);
  const std::string history = io::history_line("ngs-synth", cli::recipe_json(data.recipe).dump());
  io::write_strict_ply(path, cloud, {}, io::trained_comments(history, options.antialiased));
  run.result()["gaussians"] = cloud.size();
  run.result()["fit"] = {{"steps", options.steps},
                         {"steps_per_s", options.steps / seconds},
                         {"psnr_db", score.psnr_db},
                         {"ssim", score.ssim}};
}

}  // namespace

int main(int argc, char** argv) {
  cli::Tool tool(
      "ngs-synth", "Generate an analytic scene with exact masks and fit a splat to it.",
      {"ngs-synth torus-box -o scene/", "ngs-synth leaves -o noisy/ --mask-noise jitter:1.5,drop:0.1 --fit-steps 3000",
       "ngs-synth recipe.json -o again/ --no-fit", "ngs-synth corner -o corner/ --truth halves"});
  cli::SynthOptions options;
  FitOptions fit_options = small_fit();
  tool.options(options);
  tool.options(fit_options, {.name = "fit",
                             .about = "options of the fit to the photos",
                             .prefix = "fit_",
                             .applies = [&options] { return options.fit; },
                             .needs = "--fit"});
  const cli::Argument& name = tool.argument("recipe",
                                            "two-spheres, torus-box, leaves, bones, table, corner, ground, turntable, "
                                            "tiny, or a JSON file of recipe options");
  const cli::Output& out = tool.output_dir("-o,--output", "folder of the scene");
  tool.stops_on_request();

  return tool.run(argc, argv, [&](cli::Run& run) {
    bool is_file = false;
    cli::SynthData data;
    data.recipe = resolved(cli::load_recipe(name.value, is_file), options);
    if (is_file) run.add_input("recipe", name.value);
    cli::build(data, options.truth == cli::Truth::kHalves);
    const cli::MaskErrors errors{options.mask_noise, synth::parse_mask_noise(options.mask_noise), run.seed()};
    run.result()["views"] = data.cameras.size();
    run.result()["objects"] = data.scene.objects.size();
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
    if (options.fit && run.stop_code() == 0) fit(run, data, fit_options, out.path + "/point_cloud.ply");
    return run.stop_code();
  });
}
