#pragma once
// From the pairing of files to the scores, with what is odd about them said as warnings.
#include <map>
#include <string>

#include "metrics_json.h"

namespace ngs::cli {

struct Outcome {
  Json metrics;  // metrics.json without "pairing" and "checks"
  std::map<std::string, double> mean;
  std::string table;
};

Pairing paired(const ImageList& predicted, const ImageList& truth, const EvalOptions& options,
               const EvalFileOptions& files);
/// Throws kNothingFound where no label map has one of the wanted objects.
Outcome masks_outcome(Run& run, const EvalOptions& options, const Pairing& pairing);
Outcome photos_outcome(Run& run, const Pairing& pairing);
Outcome opacities_outcome(Run& run, const EvalOptions& options, const Pairing& pairing);

void warn_about_leftovers(Run& run, const Pairing& pairing);
/// True if all passed; says the others. What has no prediction has no score: where scores are asked for, it fails
/// unless `allow_missing`.
bool all_passed(Run& run, const std::vector<ScoreCheck>& checks, const Pairing& pairing, bool allow_missing);

}  // namespace ngs::cli
