#pragma once
// Whether the photos show edges that the model itself does not.                                    PAPER.md §5.10
//
// Contour refinement moves contours to edges of the photos. Where the model's own picture equals the photo, every edge
// of the photo is already an edge between Gaussians: nothing has to be split or moved, only the labels can be wrong,
// and many masks tell these better than an edge does. Neither the masks' contours nor the refined ones can show this,
// as both come from what is in question; the residual of the model's picture can.
#include "ngs/stages/contours/refined_masks.h"

namespace ngs {

/// Mean absolute difference, summed over the colour channels, between photo and model picture at the pixels that
/// refinement moved from one side to the other, divided by the mean contrast of the photos across the refined contours
/// (refined_masks.h). Over the objects of `views`, which `refined` [scene views] must hold; a view without a photo is
/// left out. 0: the model shows the photos exactly, or nothing was moved. At the camera's size; of a photo of 2 or 4
/// times that size the picture is rendered like the photo and averaged.
double unexplained_contrast(const Exec& exec, const Problem& problem, const LabelledModel& model,
                            const std::vector<std::size_t>& views, const std::vector<RefinedView>& refined);

/// Photos with less are explained by the model. Its renderings, saved as JPEG, have 0.003 to 0.034; photos that a splat
/// was fitted to at 28 to 34 dB have 0.13 to 0.31 (decision 078).
inline constexpr double kExplained = 0.065;

/// The same test over all views that were compared.
bool explains_photos(const Exec& exec, const Problem& problem, const LabelledModel& model,
                     const std::vector<RefinedView>& refined);

/// Whether the masks refuse the contours of `model` as refined: they agree significantly less with these, both from the
/// model and from the labels of the problem, and they are reliable: aligned with the photos' edges, or the model
/// explains the photos. A model that was trained on the masks agrees with them by construction; the problem's labels do
/// less so.
bool masks_refuse(const Exec& exec, const RefineSetup& setup, const LabelledModel& model,
                  const std::vector<RefinedView>& refined);

}  // namespace ngs
