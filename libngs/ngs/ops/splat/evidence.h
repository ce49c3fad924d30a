#pragma once
// Mask evidence per Gaussian: one forward pass per view.                 m_ij before Eq. (3); PAPER.md §5.2
#include "ngs/ops/splat/splat.h"
#include "ngs/scene/evidence.h"
#include "ngs/scene/scene.h"

namespace ngs {

/// What one view says of the Gaussians that it sees, or of those `of` them [N] (1: wanted; null: all). `masks` at the
/// camera's size; a view that is not available says nothing. A pixel's weights are those of rendering (occlusion
/// included); pixels with masks.known == 0 are not counted.
ViewSums view_sums(const Exec& exec, const GaussianCloud& cloud, const Camera& camera, const SplatOptions& options,
                   const ViewMasks& masks, const std::vector<std::uint8_t>* of = nullptr);

/// Adds that to `evidence`, without keeping it.
void add_view_evidence(const Exec& exec, const GaussianCloud& cloud, const Camera& camera,
                       const SplatOptions& options, const ViewMasks& masks, Evidence& evidence);

}  // namespace ngs
