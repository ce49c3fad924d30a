// ngs-eval: predicted and true masks -> scores (ops/metrics.h).
#include "metrics_json.h"
#include "ngs/io/atomic_file.h"

namespace ngs::cli {
namespace {

void warn_about_leftovers(Run& run, const Pairing& pairing) {
  const auto warn = [&](const std::vector<std::string>& names, const std::string& what) {
    if (names.empty()) return;
    run.monitor().warn(std::to_string(names.size()) + " " + what + ", the first is " + names.front());
  };
  warn(pairing.truth_only, "true masks without a prediction are not scored");
  warn(pairing.predicted_only, "predictions without a true mask are not scored");
  warn(pairing.listed_only, "listed views without a true mask are not scored");
  for (const auto& [rule, count] : pairing.matched_by)
    if (rule == "number")
      run.monitor().warn(std::to_string(count) +
                         " pairs were matched by their last number only, the first is " +
                         pairing.pairs.front().predicted + " = " + pairing.pairs.front().truth);
}

void warn_about_conventions(Run& run, const std::vector<PairScore>& scores) {
  int both_empty = 0, one_empty = 0, zero_one = 0;
  for (const PairScore& pair : scores) {
    both_empty += pair.scores.both_empty;
    one_empty += pair.scores.one_empty;
    zero_one += pair.predicted_zero_one || pair.truth_zero_one;
  }
  const auto warn = [&](int count, const std::string& what) {
    if (count > 0)
      run.monitor().warn(std::to_string(count) + " of " + std::to_string(scores.size()) + " pairs " + what);
  };
  warn(both_empty, "have two empty masks: scored 1");
  warn(one_empty, "have exactly one empty mask: overlap and contour scored 0");
  warn(zero_one, "have a mask of zeros and ones: read as 0/255");
}

struct Outcome {
  Json metrics;
  std::map<std::string, double> mean;
  std::string table;
};

Outcome masks_outcome(Run& run, const EvalOptions& options, const Pairing& pairing) {
  const std::vector<PairScore> scores = score_masks(run, options, pairing.pairs);
  if (scores.empty())
    throw Error(ErrorCode::kNothingFound,
                "label maps: no object with one of the ids occurs, expected at least one",
                "see the ids with ngs-eval --label-map without --object-id");
  warn_about_conventions(run, scores);
  const EvalSummary summary = summarise(scores);
  return {metrics_json(scores, summary), mean_scores(summary), score_table(scores, summary)};
}

Outcome photos_outcome(Run& run, const Pairing& pairing) {
  const std::vector<PhotoScore> scores = score_photos(run, pairing.pairs);
  return {photo_metrics_json(scores), mean_scores(scores), photo_table(scores)};
}

}  // namespace
}  // namespace ngs::cli

int main(int argc, char** argv) {
  using namespace ngs;
  cli::Tool tool("ngs-eval",
                 "Score predicted masks against true ones: IoU, accuracy, boundary IoU, contour F.",
                 {"ngs-eval masks masks_gt -o metrics.json",
                  "ngs-eval masks masks_gt --views every:4:2 --fail-below iou=0.9,biou=0.6 -o metrics.json",
                  "ngs-eval labels labels_gt --label-map -o metrics.json",
                  "ngs-eval renders photos --image-metrics -o photos.json"});
  EvalOptions options;
  cli::EvalFileOptions files;
  tool.options(options);
  tool.options(files);
  const cli::Input& predicted = tool.input("predicted", "folder of masks by any tool, or one file");
  const cli::Input& truth = tool.input("truth", "folder of true masks, or one file");
  const cli::Output& out = tool.output("-o,--output", "metrics.json");
  return tool.run(argc, argv, [&](cli::Run& run) {
    // A misspelt score is found before the work.
    check_scores(options.fail_below, files.image_metrics ? cli::mean_scores({cli::PhotoScore{}})
                                                         : cli::mean_scores(EvalSummary{}));
    const cli::Pairing pairing =
        cli::pair_files(cli::list_images(predicted.path), cli::list_images(truth.path), files);
    run.result()["pairs"] = pairing.pairs.size();
    run.result()["pairing"] = cli::pairing_json(pairing);
    if (run.dry_run()) return cli::kDone;

    cli::Outcome outcome =
        files.image_metrics ? cli::photos_outcome(run, pairing) : cli::masks_outcome(run, options, pairing);
    const std::vector<ScoreCheck> checks = check_scores(options.fail_below, outcome.mean);
    outcome.metrics["pairing"] = cli::pairing_json(pairing);
    outcome.metrics["checks"] = cli::checks_json(checks);
    cli::warn_about_leftovers(run, pairing);
    io::write_file(out.path, outcome.metrics.dump(2) + "\n");

    run.result()["mean"] = outcome.metrics["mean"];
    run.result()["files"] = Json::array();
    for (const cli::FilePair& pair : pairing.pairs)
      run.result()["files"].push_back({{"view", pair.view},
                                       {"object", pair.object},
                                       {"predicted", pair.predicted},
                                       {"truth", pair.truth}});
    run.text(outcome.table);
    bool passed = true;
    for (const ScoreCheck& check : checks) {
      if (check.passed()) continue;
      passed = false;
      run.monitor().warn("check failed: " + check.score + " = " + std::to_string(check.found) +
                         ", expected at least " + std::to_string(check.at_least));
    }
    return passed ? cli::kDone : cli::kCheckFailed;
  });
}
