#pragma once
// --instances: scores of all objects of id maps, whatever their ids (eval/instances.h).
#include "ngs/eval/instances.h"
#include "outcome.h"

namespace ngs::cli {

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
