// ngs-fit: scene.json with photos -> a trained splat.
#include <filesystem>

#include "checkpoint.h"
#include "fit_input.h"
#include "ngs/io/files/content_hash.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/scene/scene_json.h"
#include "shared/run/checkpoints.h"
#include "shared/tool.h"

namespace {

using namespace ngs;

struct CheckpointOptions {
  std::string checkpoint;
  int checkpoint_every = 1000;
  bool resume = false;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.checkpoint, Text{"checkpoint", "DIR", "keep what is needed to go on in this folder"});
    visit(self.checkpoint_every, Field<int>{"checkpoint_every", "steps", "and when a signal asks to stop", 1, 10000000});
    visit(self.resume, Flag{"resume", "go on from --checkpoint where there is one"});
  }
};

}  // namespace

int main(int argc, char** argv) {
  cli::Tool tool("ngs-fit", "Fit 3D Gaussians to posed photos (L1 + DSSIM, densify, prune, SH in steps).",
                 {"ngs-fit scene.json --points sparse/0/points3D.txt -o model.ply --steps 7000",
                  "ngs-fit scene.json --points sparse/0/points3D.txt -o model.ply --checkpoint fit/ --resume"});
  FitOptions options;
  CheckpointOptions keep;
  tool.options(options);
  tool.options(keep);
  const cli::Input& scene_json = tool.input("scene", "scene.json with photos");
  const cli::Input& points = tool.optional_input("--points", "points3D.txt, points3D.bin or a PLY to start from; default: random");
  const cli::Output& out = tool.output("-o,--output", "trained model, plain 3DGS PLY");
  tool.stops_on_request();

  return tool.run(argc, argv, [&](cli::Run& run) {
    if (keep.resume && keep.checkpoint.empty())
      throw Error(ErrorCode::kUsage, "resume without checkpoint, expected --checkpoint DIR", "name the folder of the interrupted run");
    if (points) run.warn_unused({"--random-points"}, "with --points");
    if (keep.checkpoint.empty()) run.warn_unused({"--checkpoint-every"}, "without --checkpoint");
    Scene scene = io::read_scene_json(scene_json.path);
    if (scene.compat != Compat::kInria)
      run.monitor().warn("the scene says --compat gsplat, and this fits by the rules of 3DGS: import the new model without it");
    choose_background(options.background, run.monitor(), scene);
    options.background = background_text(background_of(scene));
    const bool kept = !keep.checkpoint.empty() && std::filesystem::exists(cli::checkpoint_path(keep.checkpoint));
    if (kept && !keep.resume && !run.overwrite())
      throw Error(ErrorCode::kUsage, cli::checkpoint_path(keep.checkpoint) + ": already there, expected none",
                  "go on with --resume, or start over with -w");
    run.result()["views"] = scene.views.size();
    if (run.dry_run()) return run.plan(cli::fit_plan(options, scene, kept && keep.resume, run.exec().threads)), cli::kDone;

    const bool keeps = !keep.checkpoint.empty();
    if (keeps) cli::require_checkpoint_folder(keep.checkpoint, cli::checkpoint_path(keep.checkpoint));
    const std::vector<FitView> views = cli::load_views(run, scene);
    const cli::FitFiles files{keeps ? cli::photos_hash(scene) : "", keeps && points ? io::content_hash(points.path).xxh3 : ""};
    const std::string identity = cli::fit_identity(options, run.seed(), views, files);
    FitState state = kept && keep.resume ? cli::read_checkpoint(keep.checkpoint, identity, options.steps)
                                         : initial_fit(run.exec(), options, cli::load_points(run, options, points), views, run.seed());
    const std::int64_t first = state.step;
    Fitter fitter(options, views, std::move(state), run.seed());
    const double start = wall_seconds();
    const auto save = [&] { cli::write_checkpoint(keep.checkpoint, fitter.state(), identity); };
    cli::Checkpoints checkpoints(run.monitor());
    run_fit(run.exec(), run.monitor(), fitter, options, [&](const Fitter& f) {
      if (keeps && f.state().step % keep.checkpoint_every == 0) checkpoints.on_the_way(save);
    });
    const double seconds = wall_seconds() - start;
    run.result()["step"] = fitter.state().step;
    const bool finished = fitter.state().step == options.steps;
    if (keeps && finished && options.steps % keep.checkpoint_every != 0) checkpoints.on_the_way(save);
    if (!finished) {
      if (keeps) save();  // all that is left of the run
      run.monitor().warn("stopped at step " + std::to_string(fitter.state().step) + " of " + std::to_string(options.steps) +
                         ": no model was written, " +
                         (!keeps ? "and nothing to go on from; --checkpoint DIR would keep it"
                                 : "--resume goes on from " + keep.checkpoint));
      return run.stop_code();
    }

    const GaussianCloud& cloud = fitter.state().cloud;
    io::write_strict_ply(out.path, cloud, {}, io::trained_comments(cli::history(options), options.antialiased));
    run.result()["gaussians"] = cloud.size();
    run.result()["steps_per_s"] = double(fitter.state().step - first) / std::max(seconds, 1e-9);
    run.result()["train"] = cli::score_json(score_fit(run.exec(), options, cloud, views, Split::kTrain));
    run.result()["held_out"] = cli::score_json(score_fit(run.exec(), options, cloud, views, Split::kHeldOut));
    return cli::kDone;
  });
}
