#include "metrics_json.h"

#include <algorithm>
#include <cstdio>
#include <span>

#include "evaluation.h"
#include "ngs/core/formatted.h"
#include "shared/text/layout.h"

namespace ngs::cli {
namespace {

Json values_json(const ScoreValues& values) {
  Json json = Json::object();
  for (std::size_t k = 0; k < kScoreNames.size(); ++k) json[std::string(kScoreNames[k])] = values[k];
  return json;
}

/// Counts of a pair or of an object.
template <class Scored>
Json counts_json(const Scored& s) {
  return {{"tp", s.counts.tp},  {"fp", s.counts.fp},  {"fn", s.counts.fn},   {"tn", s.counts.tn},
          {"far_fp", s.far_fp}, {"far_fn", s.far_fn}, {"void_px", s.void_px}};
}

Json view_json(const PairScore& pair) {
  Json json = {{"view", pair.view},
               {"object", pair.object},
               {"width_px", pair.width_px},
               {"height_px", pair.height_px},
               {"predicted_width_px", pair.predicted_width_px},
               {"predicted_height_px", pair.predicted_height_px},
               {"predicted_zero_one", pair.predicted_zero_one},
               {"truth_zero_one", pair.truth_zero_one},
               {"both_empty", pair.scores.both_empty},
               {"one_empty", pair.scores.one_empty}};
  json.update(values_json(score_values(pair.scores)));
  json["counts"] = counts_json(pair.scores);
  return json;
}

Json object_json(const ObjectMean& object) {
  Json json = {{"object", object.object},
               {"pairs", object.pairs},
               {"both_empty", object.both_empty},
               {"one_empty", object.one_empty}};
  json.update(values_json(object.mean));
  json["counts"] = counts_json(object);
  return json;
}

constexpr int kNameColumns = 20, kCellColumns = 11;

/// Number of scores that fit next to a name in so many columns; 0 columns (no terminal): all.
std::size_t shown_scores(int columns) {
  const std::size_t fit = std::size_t(std::max(1, (columns - kNameColumns) / kCellColumns));
  return columns == 0 ? kScoreNames.size() : std::min(kScoreNames.size(), fit);
}

std::string table_row(const std::string& name, const ScoreValues& values, std::size_t scores) {
  std::string row = in_columns(name, kNameColumns);
  for (std::size_t k = 0; k < scores; ++k) row += formatted("  %9.4f", values[k]);
  return row + "\n";
}

std::string table_head(const std::string& name, std::size_t scores) {
  char cell[64];
  std::string row = in_columns(name, kNameColumns);
  for (const std::string_view score : std::span(kScoreNames).first(scores)) {
    std::snprintf(cell, sizeof cell, "  %9.9s", score == "class_accuracy" ? "class_acc" : std::string(score).c_str());
    row += cell;
  }
  return row + "\n";
}

std::string label_of(const PairScore& pair) { return pair.object.empty() ? pair.view : pair.view + " " + pair.object; }

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

Json metrics_json(const std::vector<PairScore>& scores, const EvalSummary& summary) {
  Json json = {{"ngs_metrics", kMetricsVersion},    {"kind", "masks"},
               {"mean", values_json(summary.mean)}, {"mean_over_pairs", values_json(summary.mean_over_pairs)},
               {"objects", Json::array()},          {"views", Json::array()}};
  for (const ObjectMean& object : summary.objects) json["objects"].push_back(object_json(object));
  for (const PairScore& pair : scores) json["views"].push_back(view_json(pair));
  return json;
}

Json alone_json(const std::vector<PairScore>& scores, const EvalSummary& summary) {
  Json json = {{"mean", values_json(summary.mean)}, {"views", Json::array()}};
  for (const PairScore& pair : scores) {
    Json view = {{"view", pair.view}, {"object", pair.object}};
    view.update(values_json(score_values(pair.scores)));
    json["views"].push_back(std::move(view));
  }
  return json;
}

Json photo_metrics_json(const std::vector<PhotoScore>& scores) {
  const std::map<std::string, double> mean = mean_scores(scores);
  Json json = {{"ngs_metrics", kMetricsVersion},
               {"kind", "photos"},
               {"mean", {{"psnr_db", mean.at("psnr_db")}, {"ssim", mean.at("ssim")}}},
               {"views", Json::array()}};
  for (const PhotoScore& score : scores)
    json["views"].push_back({{"view", score.view}, {"psnr_db", score.psnr_db}, {"ssim", score.ssim}});
  return json;
}

Json pairing_json(const Pairing& pairing) {
  Json matched_by = Json::object();
  for (const auto& [rule, count] : pairing.matched_by) matched_by[rule] = count;
  return {{"matched_by", matched_by},
          {"predicted_only", pairing.predicted_only},
          {"truth_only", pairing.truth_only},
          {"listed_only", pairing.listed_only}};
}

Json files_json(const Pairing& pairing) {
  Json json = Json::array();
  for (const FilePair& pair : pairing.pairs)
    json.push_back({{"view", pair.view},
                    {"object", pair.object},
                    {"predicted", pair.predicted},
                    {"truth", pair.truth},
                    {"truth_id", pair.truth_id}});
  return json;
}

Json checks_json(const std::vector<ScoreCheck>& checks) {
  Json json = Json::array();
  for (const ScoreCheck& check : checks)
    json.push_back(
        {{"score", check.score}, {"at_least", check.at_least}, {"found", check.found}, {"passed", check.passed()}});
  return json;
}

std::map<std::string, double> mean_scores(const EvalSummary& summary) {
  std::map<std::string, double> mean;
  for (std::size_t k = 0; k < kScoreNames.size(); ++k) mean[std::string(kScoreNames[k])] = summary.mean[k];
  return mean;
}

std::map<std::string, double> alone_scores(const EvalSummary& summary) {
  std::map<std::string, double> scores;
  for (const auto& [name, value] : mean_scores(summary)) scores["alone_" + name] = value;
  return scores;
}

std::map<std::string, double> mean_scores(const std::vector<PhotoScore>& scores) {
  double psnr_db = 0, ssim = 0;
  for (const PhotoScore& score : scores) {
    psnr_db += score.psnr_db;
    ssim += score.ssim;
  }
  return {{"psnr_db", psnr_db / double(scores.size())}, {"ssim", ssim / double(scores.size())}};
}

std::string score_table(const std::vector<PairScore>& scores, const EvalSummary& summary, int columns) {
  const std::size_t shown = shown_scores(columns);
  std::string table = table_head("object", shown);
  for (const ObjectMean& object : summary.objects)
    table += table_row(object.object.empty() ? "object" : object.object, object.mean, shown);
  if (summary.objects.size() > 1) table += table_row("mean over objects", summary.mean, shown);
  std::vector<const PairScore*> worst;
  for (const PairScore& pair : scores) worst.push_back(&pair);
  std::stable_sort(worst.begin(), worst.end(),
                   [](const PairScore* a, const PairScore* b) { return a->scores.biou < b->scores.biou; });
  const std::size_t views = columns == 0 ? 5 : 3;
  if (worst.size() > 1) table += table_head(worst.size() > views ? "worst views" : "views, worst first", shown);
  for (std::size_t i = 0; worst.size() > 1 && i < std::min(views, worst.size()); ++i)
    table += table_row(label_of(*worst[i]), score_values(worst[i]->scores), shown);
  return table;
}

std::string photo_table(const std::vector<PhotoScore>& scores) {
  const std::map<std::string, double> mean = mean_scores(scores);
  char line[128];
  std::snprintf(line, sizeof line, "%zu photos: PSNR %.2f dB, SSIM %.4f\n", scores.size(), mean.at("psnr_db"),
                mean.at("ssim"));
  return line;
}

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
