#pragma once
// metrics.json and the score table for the terminal.
#include <string>

#include "evaluation.h"

namespace ngs::cli {

inline constexpr int kMetricsVersion = 1;

/// Contains no time, host or path: the same masks give the same bytes.
Json metrics_json(const std::vector<PairScore>& scores, const EvalSummary& summary);
/// "alone" of metrics.json: mean and views, without counts.
Json alone_json(const std::vector<PairScore>& scores, const EvalSummary& summary);
Json photo_metrics_json(const std::vector<PhotoScore>& scores);
Json pairing_json(const Pairing& pairing);
/// The files of each pair, for the report.
Json files_json(const Pairing& pairing);
Json checks_json(const std::vector<ScoreCheck>& checks);

/// The scores that --fail-below accepts.
std::map<std::string, double> mean_scores(const EvalSummary& summary);
std::map<std::string, double> alone_scores(const EvalSummary& summary);  // alone_iou and so on
std::map<std::string, double> mean_scores(const std::vector<PhotoScore>& scores);

/// Mean scores of the objects, then the worst views by boundary IoU. `columns`: width of the terminal; 0: no terminal.
std::string score_table(const std::vector<PairScore>& scores, const EvalSummary& summary, int columns);
std::string photo_table(const std::vector<PhotoScore>& scores);

}  // namespace ngs::cli
