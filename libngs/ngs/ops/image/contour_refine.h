#pragma once
// A mask whose contour is moved to the edges of the photo.                                        PAPER.md
// §5.10
//
// Random walks with a prior (Grady, "Random walks for image segmentation", PAMI 2006): in a band about the
// contour of a given mask, x in [0, 1] minimises
//
//   Σ_pq w_pq (x_p - x_q)² + Σ_p (λ_s + λ_d (1 - r_p)²) (x_p - s_p)² + λ_c Σ_p r_p (x_p - c_p)²,
//   w_pq = exp(-|I_p - I_q|² / m) + 1e-5
//
// over pairs of 8 neighbours (w divided by their distance), x fixed to the mask outside the band. m is the mean of
// |I_p - I_q|² over the window's pairs side by side and one above the other, s a sigmoid of the signed distance to
// the given contour ("the contour was here"), c the probability of the photo's colour under one normal density of
// the colours inside and one outside, both estimated locally ("what looks like the object near by"), with a tenth
// of outliers in each. r in [0, 1] says how well c tells the pixels near by whose side is known: where it does not,
// colours do not pull and the given contour holds, or else edges within a texture would win. The minimum is unique:
// where the photo shows no edge and no difference in colour, s alone decides, and the contour stays.
#include <vector>

#include "ngs/ops/image/metrics.h"
#include "ngs/scene/views.h"

namespace ngs {

struct ContourRefineOptions {
  double band_px = 5;           // half width of the band in which the contour may move
  double reach_px = 40;         // colours are learned from pixels nearer than this to the contour
  double colour_weight = 0.1;   // λ_c
  double shape_weight = 3e-3;   // λ_s
  double ambiguity_weight = 3;  // λ_d
};

/// Soft mask [H·W] in [0, 1]; > 0.5 is the object. `photo` [H, W, 3] of the mask's size. Serial: views are
/// refined in parallel. A mask without a contour comes back as it is. A colour that is no number says nothing.
std::vector<float> refine_contour(const ContourRefineOptions& options, MaskPlane mask, const ImageF& photo);

}  // namespace ngs
