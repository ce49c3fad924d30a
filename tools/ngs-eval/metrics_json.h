#pragma once
// metrics.json and the score table for the terminal.
#include <map>
#include <string>

#include "evaluation.h"
#include "ngs/eval/instances.h"

namespace ngs::cli {

/// Contains no time, host or path: the same masks give the same bytes.
Json metrics_json(const std::vector<PairScore>& scores, const EvalSummary& summary);
/// "alone" of metrics.json: mean and views, without counts.
Json alone_json(const std::vector<PairScore>& scores, const EvalSummary& summary);
Json photo_metrics_json(const std::vector<PhotoScore>& scores);
Json pairing_json(const Pairing& pairing);
Json files_json(const Pairing& pairing);
Json checks_json(const std::vector<ScoreCheck>& checks);

/// The scores that --fail-below accepts.
std::map<std::string, double> mean_scores(const EvalSummary& summary);
std::map<std::string, double> alone_scores(const EvalSummary& summary);  // alone_iou and so on
std::map<std::string, double> mean_scores(const std::vector<PhotoScore>& scores);

/// Mean scores of the objects, then the worst views by boundary IoU. `columns`: width of the terminal; 0: no terminal.
std::string score_table(const std::vector<PairScore>& scores, const EvalSummary& summary, int columns);
std::string photo_table(const std::vector<PhotoScore>& scores);

// Scores all pairs and warns about unusual pairs.

struct Outcome {
  Json metrics;  // metrics.json except "pairing" and "checks"
  std::map<std::string, double> mean;
  std::string table;
};

Pairing paired(const ImageList& predicted, const ImageList& truth, const EvalOptions& options,
               const EvalFileOptions& files);
/// Throws kNothingFound if no label map contains a selected object.
Outcome masks_outcome(Run& run, const EvalOptions& options, const Pairing& pairing);
/// Adds the scores of `alone`, the opacities of each object rendered without the scene, as "alone" of the metrics.
/// In true label maps, other objects and a margin around them are void, as they may occlude the object. Throws kUsage
/// for opacities of several ids together.
void add_alone(Run& run, Pairing alone, EvalOptions options, Outcome& outcome);
Outcome photos_outcome(Run& run, const Pairing& pairing);
Outcome opacities_outcome(Run& run, const EvalOptions& options, const Pairing& pairing);

void warn_about_leftovers(Run& run, const Pairing& pairing);
/// True if all checks passed; warns about each failed check. True masks without a prediction have no score: with checks
/// they fail unless `allow_missing`.
bool all_passed(Run& run, const std::vector<ScoreCheck>& checks, const Pairing& pairing, bool allow_missing);

// --instances: scores of all objects of id maps, whatever their ids (eval/instances.h).

/// The scores of the id maps of all views together, and the mean boundary IoU of each matched object over its views.
struct SceneInstances {
  InstanceScores scores;
  std::map<std::uint32_t, double> biou = {};  // by true id
  bool of_views = true;                       // false: of Gaussians, without biou
};

/// Throws kUsage for other kinds of scores and for ids; warns about unused options. Makes the files label maps.
void check_instances_options(Run& run, EvalOptions& options, const EvalFileOptions& files);
/// pq, sq, rq, ap, ap50, ap25; of views also biou.
std::map<std::string, double> mean_scores(const SceneInstances& scene);
Outcome instances_outcome(Run& run, const EvalOptions& options, const Pairing& pairing);
/// Whether a path is that of a model, whose Gaussians are scored instead of id maps.
bool is_model(const std::string& path);
/// The same, without biou, for the Gaussians of a labelled PLY by object and by true id: another labelled PLY, or the
/// bare ids, one byte or two (little-endian) a Gaussian. An object's Gaussians have a label above 1/2, the largest of
/// all objects. kInconsistent if the numbers of Gaussians differ.
Outcome gaussians_outcome(const std::string& predicted, const std::string& truth);

}  // namespace ngs::cli
