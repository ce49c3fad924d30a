#pragma once
// Moves the contour of a mask to the edges of the photo.                                            paper.md §5.10
//
// Random walks with a prior (Grady, "Random walks for image segmentation", PAMI 2006). In a band around the contour of
// a given mask, x in [0, 1] minimises
//
//   Σ_pq w_pq (x_p - x_q)² + Σ_p (λ_s + λ_d (1 - r_p)²) (x_p - s_p)² + λ_c Σ_p r_p (x_p - c_p)²,
//   w_pq = exp(-|I_p - I_q|² / m) + 1e-5
//
// over pairs of 8-neighbours (w divided by their distance). Outside the band, x is fixed to the mask.
//
// clang-format off
//   m   mean of |I_p - I_q|² over horizontal and vertical neighbours in the window
//   s   shape prior: a sigmoid of the signed distance to the given contour
//   c   colour prior: probability of the object, from one normal density of the colours inside and one of those
//       outside. Both are estimated locally, with a tenth of outliers each.
//   r   in [0, 1]: how well c classifies nearby pixels whose side is known. Where r is low, colours have no weight and
//       the given contour stays; otherwise edges within a texture would attract it.
// clang-format on
//
// The minimum is unique. Where the photo has neither an edge nor a difference in colour, s alone decides, and the
// contour stays.
#include <vector>

#include "ngs/ops/image/metrics.h"
#include "ngs/scene/views.h"

namespace ngs {

struct ContourRefineOptions {
  double band_px = 5;           // half width of the band in which the contour can move
  double reach_px = 40;         // colours are learned from pixels nearer than this to the contour
  double colour_weight = 0.1;   // λ_c
  double shape_weight = 3e-3;   // λ_s
  double ambiguity_weight = 3;  // λ_d
};

/// Returns a soft mask [H·W] in [0, 1]; > 0.5 is the object. `photo`: [H, W, 3] in the size of the mask. Serial:
/// callers refine views in parallel. A mask without a contour is returned unchanged. Non-finite colours count as the
/// mean colour.
std::vector<float> refine_contour(const ContourRefineOptions& options, MaskPlane mask, const ImageF& photo);

}  // namespace ngs
