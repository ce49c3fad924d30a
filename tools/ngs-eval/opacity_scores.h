#pragma once
// Scores of the opacity of an object rendered alone against its true silhouettes (ops/image/opacity_errors.h).
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

/// Throws kUsage if true label maps are given without the id of one object.
void require_one_object(const EvalOptions& options);

/// In label maps, pixels of other objects are ignored, because they may occlude the object. Views without a contour of
/// the object have no score. Throws kNothingFound if no view has a contour.
std::vector<OpacityScore> score_opacities(Run& run, const EvalOptions& options, const std::vector<FilePair>& pairs);

Json opacity_metrics_json(const std::vector<OpacityScore>& scores);
/// Mean scores by name, halo_1px to holes_5px.
std::map<std::string, double> mean_scores(const std::vector<OpacityScore>& scores);
std::string opacity_table(const std::vector<OpacityScore>& scores);

}  // namespace ngs::cli
