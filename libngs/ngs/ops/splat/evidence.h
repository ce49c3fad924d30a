#pragma once
// Mask evidence per Gaussian: one forward pass per view.                 m_ij before Eq. (3); PAPER.md §5.2
#include "ngs/math/row_numbers.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/scene/evidence.h"
#include "ngs/scene/scene.h"

namespace ngs {

/// What a pixel counts for a Gaussian of opacity α there, before which a part T of the light is left.
enum class PixelWeight : std::uint8_t {
  kRendered,      // w = α T, what it adds to the picture
  kByVisibility,  // α T², less where it only shows through others; on the CPU whatever the device
};

/// A camera and the masks of its view, at its size.
struct MaskedView {
  const Camera& camera;
  const ViewMasks& masks;
  PixelWeight weight = PixelWeight::kRendered;
};

/// What one view says of the Gaussians that it sees, or of those `of` them, whose rows are then their numbers there. A
/// view whose masks are not available says nothing. A pixel's weights are those of rendering (occlusion
/// included); pixels with masks.known == 0 are not counted.
ViewSums view_sums(const Exec& exec, const GaussianCloud& cloud, const MaskedView& view, const SplatOptions& options,
                   const RowNumbers* of = nullptr);

/// The weights of that, packed.
ViewWeights view_weights(const Exec& exec, const GaussianCloud& cloud, const MaskedView& view,
                         const SplatOptions& options, const RowNumbers* of = nullptr);

/// Adds that to `evidence`, without keeping it.
void add_view_evidence(const Exec& exec, const GaussianCloud& cloud, const MaskedView& view,
                       const SplatOptions& options, Evidence& evidence);

}  // namespace ngs
