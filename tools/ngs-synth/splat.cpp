#include "splat.h"

#include "ngs/io/ply/gaussian_ply.h"

namespace ngs::cli {

FitOptions small_fit() {
  FitOptions options;
  options.steps = 1500, options.sh_degree = 1, options.max_gaussians = 8000;
  options.near_loss = 0;  // initial points are on the surfaces, and measured tables refer to these splats
  return options;
}

void make_finer(FitOptions& options, const synth::Recipe& recipe) {
  if (options.max_gaussians == small_fit().max_gaussians) options.max_gaussians = 20000 + 200 * recipe.objects;
  if (options.steps == small_fit().steps) options.steps = 800;
}

void fit_splat(Run& run, const SynthData& data, const FitOptions& options, const std::string& path) {
  const std::vector<FitView> views = fit_views(data);
  Fitter fitter(options, views, initial_fit(run.exec(), options, fit_points(data.points), views, run.seed()),
                run.seed());
  const double start = wall_seconds();
  run_fit(run.exec(), run.monitor(), fitter, options, {});
  const double seconds = wall_seconds() - start;
  if (run.stop_code() != 0) return;
  const GaussianCloud& cloud = fitter.state().cloud;
  const FitScore score = score_fit(run.exec(), options, cloud, views, Split::kTrain);
  const std::string history = io::history_line("ngs-synth", recipe_json(data.recipe).dump());
  io::write_strict_ply(path, cloud, {}, io::trained_comments(history, options.antialiased));
  run.result()["gaussians"] = cloud.size();
  run.result()["fit"] = {{"steps", options.steps},
                         {"max_gaussians", options.max_gaussians},
                         {"steps_per_s", options.steps / seconds},
                         {"psnr_db", score.psnr_db},
                         {"ssim", score.ssim}};
}

}  // namespace ngs::cli
