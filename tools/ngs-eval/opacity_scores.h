#pragma once
// Scores of an object's opacity, rendered alone, against its true silhouettes (ops/image/opacity_errors.h).
#include <map>
#include <string>
#include <vector>

#include "evaluation.h"
#include "ngs/ops/image/opacity_errors.h"

namespace ngs::cli {

struct OpacityScore {
  std::string view;
  OpacityErrors errors;
};

/// kUsage where true label maps are given without the id of one object.
void require_one_object(const EvalOptions& options);

/// Other objects of label maps may stand before the object: what is there and beside it counts nowhere. Views without
/// a contour of the object have no score; throws kNothingFound where no view has one.
std::vector<OpacityScore> score_opacities(Run& run, const EvalOptions& options, const std::vector<FilePair>& pairs);

Json opacity_metrics_json(const std::vector<OpacityScore>& scores);
/// By name, halo_1px to holes_5px.
std::map<std::string, double> mean_scores(const std::vector<OpacityScore>& scores);
std::string opacity_table(const std::vector<OpacityScore>& scores);

}  // namespace ngs::cli
