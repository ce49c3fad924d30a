#pragma once
// L_mask: rendered masks against given masks, heavier where the field is dense.   Eq. (19); C18, C19
//
//   L = view_weight / N Σ_p s_p Σ_k ℓ(rendered_pk, target_pk),   s_p = sigmoid(D_p) in [0.5, 1),   N = known pixels
//
// The paper's formula has prediction and truth exchanged; ℓ is the ordinary cross-entropy, or the linear loss to which
// the literal formula reduces. Unknown pixels have no loss and no gradient. Without known pixels the loss is 0. The
// weights s carry no gradient. Results do not depend on exec.threads.
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/math/pixel_grid.h"
#include "ngs/scene/query_field.h"
#include "ngs/scene/scene.h"

namespace ngs {

enum class MaskLossForm : std::uint8_t { kBce, kLinear };

struct MaskLossOptions {
  MaskLossForm form = MaskLossForm::kBce;
  double lambda = 1;  // linear form: weight of pixels outside the object
};

/// Density of the field at the nodes of a view's grid.
struct FieldDensity {
  PixelGrid grid;
  PixelBox box;                             // outside it the weight is 0.5
  const std::vector<float>& optical_depth;  // one value per node, VolumeOutput::optical_depth
};

/// The weight s_p of every pixel.
ImageF density_weights(const Exec& exec, int width_px, int height_px, const FieldDensity& field);

struct MaskLossInputs {
  const ImageF* rendered = nullptr;      // [H, W, K] RenderedView::label
  const ViewMasks* masks = nullptr;      // K targets of the same size; not available: loss 0
  const ImageF* pixel_weight = nullptr;  // [H, W, 1] density_weights; null: 1
  double view_weight = 1;                // of this view's masks, >= 0
};

struct MaskLoss {
  double total = 0;
  std::int64_t known = 0;  // pixels
};

/// `gradient`: null, or weight · ∂total/∂rendered, overwritten, shaped like `rendered`.
MaskLoss loss_mask(const Exec& exec, const MaskLossOptions& options, const MaskLossInputs& in, double weight,
                   ImageF* gradient);

}  // namespace ngs
