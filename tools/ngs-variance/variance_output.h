#pragma once
// What ngs-variance and ngs-variance merge share: shards, checks and the artifacts.
#include <string>
#include <vector>

#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/scene/evidence_file.h"
#include "ngs/stages/boundary/variance_stage.h"
#include "shared/run/run.h"
#include "shared/scene/scene_model.h"

namespace ngs::variance {

/// Shard "i/N" of the views: contiguous, sizes differing by at most one. kUsage for anything else.
std::vector<std::size_t> shard_of(const std::vector<std::size_t>& views, const std::string& shard);

/// EvidencePart::made_with of parts of the scene in this file.
std::string made_with(const std::string& scene_path, const SplatOptions& splat);

/// Estimated peak memory for --dry-run.
Json memory_plan(const GaussianCloud& cloud, const Scene& scene, std::size_t views);

/// The scene `given` or, if that is empty, the one that the parts name, with the objects that the parts have columns
/// of, in their order; it and its model become inputs of the run. kInconsistent where it is not the scene the parts
/// were made from.
Scene scene_of(cli::Run& run, const io::EvidencePart& sum, const std::string& given);

/// kInconsistent unless the merged parts are of this scene's model and of exactly its training views.
void check_complete(const io::EvidencePart& sum, const Scene& scene);

struct LabelledScene {
  const Scene& scene;
  const io::GaussianPly& ply;
  std::vector<LabelColumns> labels;  // [objects of the scene]
  std::vector<float> weight;         // [N] of their evidence
  BoundaryRule rule;
};

/// The evidence, the most that there is in memory, is gone then.
LabelledScene label(const BoundaryRule& rule, const Scene& scene, const io::GaussianPly& ply,
                    Evidence&& evidence);

/// Writes the labelled PLY and the counts; an empty boundary set is kNothingFound unless allowed.
void write_labels(cli::Run& run, const LabelledScene& labelled, const std::string& path);

/// One EXR per training view: the first object's ngs.mask, ngs.prob, ngs.variance and ngs.boundary,
/// composited.
void write_layers(cli::Run& run, const LabelledScene& labelled, const SplatOptions& splat, const std::string& folder);

}  // namespace ngs::variance
