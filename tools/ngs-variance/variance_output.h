#pragma once
// Shards, checks and outputs that ngs-variance and ngs-variance merge share.
#include <string>
#include <vector>

#include "ngs/capture/mask_agreement.h"
#include "ngs/cut/evidence/variance_stage.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/scene/evidence_file.h"
#include "shared/run/run.h"
#include "shared/scene/scene_model.h"

namespace ngs::variance {

/// Shard "i/N" of the views: contiguous, sizes differ by at most one. Throws kUsage for any other text.
std::vector<std::size_t> shard_of(const std::vector<std::size_t>& views, const std::string& shard);

/// The value of EvidencePart::made_with for parts of the scene in this file.
std::string made_with(const std::string& scene_path, const SplatOptions& splat);

/// Estimated peak memory for --dry-run.
Json memory_plan(const GaussianCloud& cloud, const Scene& scene, std::size_t views);

/// The scene `given` or, if that is empty, the one named in the parts. It has the objects of the parts, in the order of
/// their columns. The scene and its model become inputs of the run. Throws kInconsistent if the parts were made from
/// another scene.
Scene scene_of(cli::Run& run, const io::EvidencePart& sum, const std::string& given);

/// Throws kInconsistent unless the merged parts belong to this scene's model and cover exactly its training views.
void check_complete(const io::EvidencePart& sum, const Scene& scene);

struct LabelledScene {
  const Scene& scene;
  const io::GaussianPly& ply;
  std::vector<LabelColumns> labels;  // [objects of the scene]
  std::vector<float> weight;         // [N] total rendering weight
  BoundaryRule rule;
};

/// Consumes the evidence, the largest data in memory.
LabelledScene label(const BoundaryRule& rule, const Scene& scene, const io::GaussianPly& ply, Evidence&& evidence);

/// Writes the labelled PLY and reports the counts. Throws kNothingFound for an empty boundary set unless --allow-empty.
void write_labels(cli::Run& run, const LabelledScene& labelled, const std::string& path);

/// One EXR per training view with the first object's ngs.mask, .prob, .variance and .boundary, alpha-composited.
void write_exr(cli::Run& run, const LabelledScene& labelled, const SplatOptions& splat, const std::string& folder);

// Fails if the masks of a scene do not fit its views, with the cause and the command that mends it.

/// Reports capture/mask_agreement.h. Throws kInconsistent unless the verdict is kFit.
void check_masks(cli::Run& run, const MaskAgreementOptions& options, const EvidenceInputs& in);

}  // namespace ngs::variance
