#include "outcome.h"

#include <algorithm>

#include "opacity_scores.h"

namespace ngs::cli {
namespace {

/// True if the aspect ratios differ by more than rounding of sizes explains.
bool is_other_shape(const PairScore& pair) {
  const double across = double(pair.predicted_width_px) / pair.width_px,
               down = double(pair.predicted_height_px) / pair.height_px;
  const double rounding =
      1.0 / std::min({pair.width_px, pair.height_px, pair.predicted_width_px, pair.predicted_height_px});
  return std::max(across, down) > std::min(across, down) * (1.02 + 2 * rounding);
}

/// True if the prediction has a lower resolution, by more than rounding of sizes explains.
bool is_enlarged(const PairScore& pair) {
  return pair.predicted_width_px + 1 < pair.width_px || pair.predicted_height_px + 1 < pair.height_px;
}

/// The larger pixels of an enlarged mask limit its contour scores, whatever the quality of its contour.
void warn_about_enlarged(Run& run, const std::vector<PairScore>& scores) {
  const auto count = std::ranges::count_if(scores, is_enlarged);
  if (count == 0) return;
  const PairScore& first = *std::ranges::find_if(scores, is_enlarged);
  const auto size = [](int width_px, int height_px) {
    return std::to_string(width_px) + "x" + std::to_string(height_px);
  };
  run.monitor().warn(
      std::to_string(count) + " of " + std::to_string(scores.size()) +
      " predictions are smaller than the truth and were enlarged, the first is " + first.view + ", " +
      size(first.predicted_width_px, first.predicted_height_px) + " to " + size(first.width_px, first.height_px) +
      ": contour scores are lower for this reason (ngs-render --scale 0 renders masks at the photos' size)");
}

void warn_about_conventions(Run& run, const std::vector<PairScore>& scores) {
  constexpr double kExchanged = 0.05;  // accuracy
  int both_empty = 0, one_empty = 0, zero_one = 0, other_shape = 0, usual_void = 0, exchanged = 0;
  for (const PairScore& pair : scores) {
    both_empty += pair.scores.both_empty;
    one_empty += pair.scores.one_empty;
    exchanged += pair.scores.accuracy < kExchanged;
    zero_one += pair.predicted_zero_one || pair.truth_zero_one;
    other_shape += is_other_shape(pair);
    usual_void += pair.truth_has_usual_void;
  }
  const auto warn = [&](int count, const std::string& what) {
    if (count > 0)
      run.monitor().warn(std::to_string(count) + " of " + std::to_string(scores.size()) + " pairs " + what);
  };
  warn(both_empty, "have two empty masks: scored 1");
  warn(one_empty, "have exactly one empty mask: overlap and contour scored 0");
  warn(exchanged, "agree in less than 5 % of the pixels: black and white look exchanged in one of them");
  warn(zero_one, "have a mask of zeros and ones: read as 0/255");
  warn(usual_void,
       "have a true label map with 255 and other ids: if 255 marks pixels without a label, add --void-id 255");
  warn(other_shape,
       "have masks of different aspect ratios (rotated or cropped?): the prediction was stretched to the truth's size");
}

}  // namespace

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
      run.monitor().warn(std::to_string(count) + " pairs were matched by their last number only, the first is " +
                         pairing.pairs.front().predicted + " = " + pairing.pairs.front().truth);
}

Pairing paired(const ImageList& predicted, const ImageList& truth, const EvalOptions& options,
               const EvalFileOptions& files) {
  if (options.label_map && depth(predicted) > depth(truth))
    return pair_objects(predicted, truth, files, parse_object_ids(options.object_id));
  return pair_files(predicted, truth, files);
}

Outcome masks_outcome(Run& run, const EvalOptions& options, const Pairing& pairing) {
  const std::vector<PairScore> scores = score_masks(run, options, pairing.pairs);
  if (scores.empty())
    throw Error(ErrorCode::kNothingFound, "label maps: none contains one of the ids, expected at least one",
                "list the ids with ngs-eval --label-map without --object-id");
  warn_about_conventions(run, scores);
  warn_about_enlarged(run, scores);
  const EvalSummary summary = summarise(scores);
  return {metrics_json(scores, summary), mean_scores(summary), score_table(scores, summary, run.columns())};
}

void add_alone(Run& run, Pairing alone, EvalOptions options, Outcome& outcome) {
  const ObjectIds ids = parse_object_ids(options.object_id);
  for (FilePair& pair : alone.pairs)
    if (options.label_map && pair.truth_id == 0) {  // opacities are no label map
      if (ids.size() != 1)
        throw Error(ErrorCode::kUsage,
                    "--alone with " + std::to_string(ids.size()) + " ids of label maps, expected one",
                    "render each object alone, into a folder with its name, or choose one by --object-id");
      pair.truth_id = ids.begin()->first;
    }
  options.occluder_margin_px = kOccluderMargin_px;
  const std::vector<PairScore> scores = score_masks(run, options, alone.pairs);
  const EvalSummary summary = summarise(scores);
  outcome.metrics["alone"] = alone_json(scores, summary);
  outcome.mean.merge(alone_scores(summary));
  outcome.table += "rendered alone:\n" + score_table(scores, summary, run.columns());
}

Outcome photos_outcome(Run& run, const Pairing& pairing) {
  const std::vector<PhotoScore> scores = score_photos(run, pairing.pairs);
  return {photo_metrics_json(scores), mean_scores(scores), photo_table(scores)};
}

Outcome opacities_outcome(Run& run, const EvalOptions& options, const Pairing& pairing) {
  const std::vector<OpacityScore> scores = score_opacities(run, options, pairing.pairs);
  return {opacity_metrics_json(scores), mean_scores(scores), opacity_table(scores)};
}

bool all_passed(Run& run, const std::vector<ScoreCheck>& checks, const Pairing& pairing, bool allow_missing) {
  bool passed = true;
  if (const auto missing = pairing.truth_only.size(); !checks.empty() && missing > 0 && !allow_missing) {
    passed = false;
    run.monitor().warn("check failed: " + std::to_string(missing) + " of " +
                       std::to_string(missing + pairing.pairs.size()) +
                       " true masks have no prediction, expected none (--allow-missing accepts that)");
  }
  for (const ScoreCheck& check : checks) {
    if (check.passed()) continue;
    passed = false;
    run.monitor().warn("check failed: " + check.score + " = " + std::to_string(check.found) + ", expected at least " +
                       std::to_string(check.at_least));
  }
  return passed;
}

}  // namespace ngs::cli
