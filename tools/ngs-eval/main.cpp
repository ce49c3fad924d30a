// ngs-eval: scores predicted masks against true masks (ops/image/metrics.h).
#include <optional>

#include "evaluation.h"
#include "metrics_json.h"
#include "ngs/io/files/atomic_file.h"
#include "shared/tool.h"

namespace {

using namespace ngs;

/// The scores that --fail-below accepts.
std::map<std::string, double> scores_of(const cli::EvalFileOptions& files, bool with_alone) {
  using namespace cli;
  if (files.image_metrics) return mean_scores({PhotoScore{}});
  if (files.opacity) return mean_scores({OpacityScore{}});
  if (files.instances) return mean_scores(SceneInstances{});
  std::map<std::string, double> scores = mean_scores(EvalSummary{});
  if (with_alone) scores.merge(alone_scores(EvalSummary{}));
  return scores;
}

/// Throws kUsage for options that contradict each other, before any work; warns about unused ones.
void check_options(cli::Run& run, const EvalOptions& options, const cli::EvalFileOptions& files, bool with_alone) {
  require_consistent(options);
  if (files.image_metrics && files.opacity)
    throw Error(ErrorCode::kUsage, "--image-metrics and --opacity, expected one of them");
  if (files.opacity) cli::require_one_object(options);
  if (files.image_metrics)
    run.warn_unused({"--threshold"}, "with --image-metrics");
  else if (options.label_map && !files.instances)
    run.warn_unused({"--threshold"}, "with --label-map");
  // A misspelt score name fails before the work.
  check_scores(options.fail_below, scores_of(files, with_alone));
}

cli::Outcome outcome_of(cli::Run& run, const EvalOptions& options, const cli::EvalFileOptions& files,
                        const cli::Pairing& pairing) {
  if (files.image_metrics) return cli::photos_outcome(run, pairing);
  if (files.opacity) return cli::opacities_outcome(run, options, pairing);
  if (files.instances) return cli::instances_outcome(run, options, pairing);
  return cli::masks_outcome(run, options, pairing);
}

/// As masks_of_scene() of a scene.json.
std::optional<cli::Masks> masks_of(cli::Run& run, const std::string& predicted, const std::string& truth,
                                   EvalOptions& options, cli::EvalFileOptions& files) {
  if (!cli::is_scene_file(truth)) return cli::Masks{cli::list_images(predicted), cli::list_images(truth)};
  run.warn_unused({"--layout"}, "with a scene.json, which sets the layout");
  return cli::masks_of_scene(run, predicted, truth, options, files);
}

}  // namespace

int main(int argc, char** argv) {
  cli::Tool tool("ngs-eval", "Score predicted masks against true ones: IoU, accuracy, boundary IoU, contour F.",
                 {"ngs-eval masks masks_gt -o metrics.json", "ngs-eval masks scene.json -o metrics.json",
                  "ngs-eval masks masks_gt --views every:4:2 --fail-below iou=0.9,biou=0.6 -o metrics.json",
                  "ngs-eval labels labels_gt --label-map --void-id 255 -o metrics.json",
                  "ngs-eval renders photos --image-metrics -o photos.json",
                  "ngs-eval object_alpha masks_gt --opacity -o halo.json",
                  "ngs-eval ids labels_gt --instances --fail-below pq=0.9 -o instances.json",
                  "ngs-eval cut scene/halves --halves --model scene/point_cloud.ply -o halves.json"});
  EvalOptions options;
  cli::EvalFileOptions files;
  tool.options(options);
  tool.options(files);
  const cli::Input& predicted = tool.input(
      "predicted",
      "folder of masks from any tool, or one file; of a scene.json its input masks; "
      "with --halves a folder with object.ply, background.ply or both; with --instances also a labelled PLY");
  const cli::Input& truth = tool.input(
      "truth",
      "folder of true masks, or one file; of a scene.json the true masks of its held-out views; "
      "with --halves the folder halves/ of ngs-synth; of a labelled PLY another one, or the Gaussians' ids as "
      "bytes");
  const cli::Input& model =
      tool.optional_input("--model", "with --halves: the uncut model, for changes outside of the hole");
  const cli::Input& alone = tool.optional_input(
      "--alone", "folder of ngs-render object.ply --layers alpha: adds the scores of the object rendered alone");
  const cli::Output& out = tool.output("-o,--output", "metrics.json");
  return tool.run(argc, argv, [&](cli::Run& run) {
    cli::check_instances_options(run, options, files);
    cli::check_halves_options(run, options, files);
    if (files.halves) return cli::score_halves(run, {predicted.path, truth.path, model.path, out.path}), cli::kDone;
    if (files.image_metrics || files.opacity) run.warn_unused({"--alone"}, "with --image-metrics or --opacity");
    const bool scores_alone = alone && !files.image_metrics && !files.opacity && !files.instances;
    check_options(run, options, files, scores_alone);
    const bool of_gaussians = files.instances && cli::is_model(predicted.path);
    const std::optional<cli::Masks> masks =
        of_gaussians ? cli::Masks{} : masks_of(run, predicted.path, truth.path, options, files);
    if (!masks) return cli::kDone;
    const cli::Pairing pairing =
        of_gaussians ? cli::Pairing{} : cli::paired(masks->predicted, masks->truth, options, files);
    run.result()["pairs"] = pairing.pairs.size();
    run.result()["pairing"] = cli::pairing_json(pairing);
    if (run.dry_run()) return cli::kDone;

    cli::Outcome outcome =
        of_gaussians ? cli::gaussians_outcome(predicted.path, truth.path) : outcome_of(run, options, files, pairing);
    if (scores_alone)
      cli::add_alone(run, cli::paired(cli::list_images(alone.path), masks->truth, options, files), options, outcome);
    const std::vector<ScoreCheck> checks = check_scores(options.fail_below, outcome.mean);
    outcome.metrics["pairing"] = cli::pairing_json(pairing);
    outcome.metrics["checks"] = cli::checks_json(checks);
    cli::warn_about_leftovers(run, pairing);
    // File names may be invalid UTF-8, which JSON does not allow.
    io::write_file(out.path, outcome.metrics.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");

    run.result()["mean"] = outcome.metrics["mean"];
    run.result()["files"] = cli::files_json(pairing);
    run.text(outcome.table);
    return cli::all_passed(run, checks, pairing, files.allow_missing) ? cli::kDone : cli::kCheckFailed;
  });
}
