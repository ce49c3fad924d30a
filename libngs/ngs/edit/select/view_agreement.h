#pragma once
// How well a labelled model fits the masks that it was made from: the labels are rendered at the views and compared
// with the masks. It is no accuracy, because the masks may be wrong; but labels that contradict the masks of several
// views are.
#include <span>
#include <vector>

#include "ngs/edit/select/stroke_agreement.h"
#include "ngs/scene/labels/label_column.h"
#include "ngs/scene/views.h"

namespace ngs {

/// Mean IoU over the views between the rendered labels and the masks. An empty vector is a view without a mask. Views
/// in which both are empty do not count; 1 without a view that counts. A mask has the size of its camera.
double view_agreement(const Exec& exec, const LabelledSplat& model, std::span<const Camera> cameras,
                      std::span<const PixelMask> masks);

struct ResultQuality {
  double strokes_wrong = 0;  // StrokeAgreement::wrong_share()
  double agreement = 1;      // view_agreement() with the masks that the result was made from
};

/// True if `result` contradicts strokes, or the masks of its views, by more than `other` does, beyond a small margin.
bool is_worse(const ResultQuality& result, const ResultQuality& other);

/// Replaces the labels of the boundary Gaussians of `trained` by those of `first`, which has the same rows. The masks
/// of a boundary Gaussian disagree: if all masks were segmented from one expected object, that object decides. Returns
/// [N] the column ngs_fixed: 1 for these Gaussians.
std::vector<float> fix_boundary(const LabelColumns& first, LabelColumns& trained);

}  // namespace ngs
