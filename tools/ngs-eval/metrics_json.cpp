#include "metrics_json.h"

#include <algorithm>
#include <cstdio>
#include <span>

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
  for (const PhotoScore& score : scores) psnr_db += score.psnr_db, ssim += score.ssim;
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

}  // namespace ngs::cli
