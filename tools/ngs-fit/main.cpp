// ngs-fit: trains a splat on the photos of a scene.json.
#include <filesystem>
#include <optional>

#include "checkpoint.h"
#include "ngs/io/files/content_hash.h"
#include "ngs/io/formats/write_splat.h"
#include "shared/run/checkpoints.h"
#include "shared/run/signals.h"
#include "shared/tool.h"

namespace {

using namespace ngs;

struct Files {
  const cli::Input &scene, &points;
  const cli::Output& out;
};

void check_options(cli::Run& run, const cli::CheckpointOptions& keep, const Files& files) {
  if (keep.resume && !keep.is_on())
    throw Error(ErrorCode::kUsage, "--resume without --checkpoint, expected --checkpoint DIR",
                "name the folder of the interrupted run");
  if (files.points) run.warn_unused({"--random-points"}, "with --points");
  if (!keep.is_on()) run.warn_unused({"--checkpoint-every"}, "without --checkpoint");
}

/// True if there is a state to resume from. Without --resume an existing state is replaced only with -w.
bool resumes(const cli::Run& run, const cli::CheckpointOptions& keep) {
  const bool kept = keep.is_on() && std::filesystem::exists(cli::checkpoint_path(keep.checkpoint));
  if (kept && !keep.resume && !run.overwrite() && !run.is_restart())
    throw Error(ErrorCode::kUsage, cli::checkpoint_path(keep.checkpoint) + ": exists already, expected none",
                "continue with --resume, or start over with -w");
  return kept && keep.resume;
}

void warn_of_stop(cli::Run& run, std::int64_t step, std::int64_t steps, const cli::CheckpointOptions& keep) {
  const std::string rest = keep.is_on() ? "--resume continues from " + keep.checkpoint
                                        : "and no checkpoint; --checkpoint DIR would write one";
  run.monitor().warn("stopped at step " + std::to_string(step) + " of " + std::to_string(steps) +
                     ": no model was written, " + rest);
}

int fit(cli::Run& run, FitOptions& options, const cli::CheckpointOptions& keep, const Files& files) {
  check_options(run, keep, files);
  const Scene scene = cli::read_fit_scene(run, files.scene.path, options);
  const bool goes_on = resumes(run, keep);
  if (run.dry_run()) return run.plan(cli::fit_plan(options, scene, goes_on, run.exec().threads)), cli::kDone;

  if (keep.is_on()) cli::require_checkpoint_folder(keep.checkpoint, cli::checkpoint_path(keep.checkpoint));
  const std::vector<FitView> views = cli::load_views(run, scene);
  const cli::FitFiles read{keep.is_on() ? cli::photos_hash(scene) : "",
                           keep.is_on() && files.points ? io::content_hash(files.points.path).xxh3 : ""};
  const auto identity = cli::fit_identity(options, run.seed(), views, read);
  FitState state =
      goes_on ? cli::read_checkpoint(keep.checkpoint, identity, options.steps)
              : initial_fit(run.exec(), options, cli::load_points(run, options, files.points), views, run.seed());
  const std::int64_t first = state.step;
  Fitter fitter(options, views, std::move(state), run.seed());
  const double began_s = wall_seconds();
  const auto save = [&] { cli::write_checkpoint(keep.checkpoint, fitter.state(), identity); };
  cli::Checkpoints checkpoints(run.monitor());
  std::optional<cli::SignalGrace> grace;
  if (keep.is_on()) grace.emplace();
  run_fit(run.exec(), run.monitor(), fitter, options, [&](const Fitter& f) {
    if (keep.is_on() && f.steps_done() % keep.checkpoint_every == 0) checkpoints.write_during_run(f.steps_done(), save);
  });
  const double taken_s = std::max(wall_seconds() - began_s, 1e-9);
  run.result()["step"] = fitter.state().step;
  if (fitter.state().step < options.steps) {
    if (keep.is_on()) checkpoints.write_on_stop(fitter.state().step, save);  // the only output of a stopped run
    warn_of_stop(run, fitter.state().step, options.steps, keep);
    return run.stop_code();
  }
  if (keep.is_on() && options.steps % keep.checkpoint_every != 0) checkpoints.write_during_run(options.steps, save);
  grace.reset();

  const GaussianCloud& cloud = fitter.state().cloud;
  const auto score = [&](Split split) { return cli::score_json(score_fit(run.exec(), options, cloud, views, split)); };
  run.result()["gaussians"] = cloud.size();
  run.result()["steps_per_s"] = double(fitter.state().step - first) / taken_s;
  run.result()["train"] = score(Split::kTrain);
  run.result()["held_out"] = score(Split::kHeldOut);
  const std::vector<std::string> comments = io::trained_comments(cli::history(options), options.antialiased);
  for (const std::string& note : io::write_splat(files.out.path, cloud, {}, comments)) run.monitor().warn(note);
  return cli::kDone;
}

}  // namespace

int main(int argc, char** argv) {
  cli::Tool tool("ngs-fit",
                 "Fit 3D Gaussians to posed photos (L1 + DSSIM, densification, pruning, SH degree in steps).",
                 {"ngs-fit scene.json --points sparse/0/points3D.txt -o model.ply --steps 7000",
                  "ngs-fit scene.json --points sparse/0/points3D.txt -o model.ply --checkpoint fit/ --resume"});
  FitOptions options;
  cli::CheckpointOptions keep;
  tool.options(options);
  tool.options(keep);
  const cli::Input& scene_json = tool.input("scene", "scene.json with photos");
  const cli::Input& points =
      tool.optional_input("--points", "points3D.txt, points3D.bin or a PLY to start from; default: random");
  const cli::Output& out =
      tool.output("-o,--output", std::string("trained model, as plain 3DGS ") + io::kOutputFormats);
  tool.stops_on_request();
  tool.runs_on_device();

  return tool.run(argc, argv, [&](cli::Run& run) { return fit(run, options, keep, {scene_json, points, out}); });
}
