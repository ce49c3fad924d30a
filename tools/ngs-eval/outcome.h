#pragma once
// Scores all pairs and warns about unusual pairs.
#include <map>
#include <string>

#include "metrics_json.h"

namespace ngs::cli {

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

}  // namespace ngs::cli
