#pragma once
// Tests whether the photos show edges that the model does not.                                     paper.md §5.10
//
// Contour refinement moves contours to edges of the photos. If the model's rendering equals the photo, every edge of
// the photo is already an edge between Gaussians. Then no Gaussian must be split or moved; only labels can be wrong,
// and many masks determine labels better than an edge does. The residual of the rendering detects this case. The masks'
// contours and the refined contours cannot, because they are what is tested.
#include "ngs/cut/contours/refined_masks.h"

namespace ngs {

/// Mean absolute difference between photo and rendering, summed over the colour channels, at the pixels that refinement
/// moved across a contour, divided by the mean contrast of the photos across the refined contours (refined_masks.h).
/// The mean is over all objects of `views`, which `refined` [scene views] must contain; views without a photo are
/// skipped. 0: the rendering equals the photos, or no pixel moved. Differences are taken at the camera's size. For
/// photos of 2 or 4 times that size, the rendering has the photo's size and is averaged.
double unexplained_contrast(const Exec& exec, const Problem& problem, const LabelledModel& model,
                            const std::vector<std::size_t>& views, const std::vector<RefinedView>& refined);

/// The model explains photos with a smaller value. Renderings of the model, saved as JPEG, have 0.003 to 0.034; photos
/// that the model was fitted to, at 28 to 34 dB, have 0.13 to 0.31 (decision 078).
inline constexpr double kExplained = 0.065;

/// True: the model explains the photos of all compared views.
bool explains_photos(const Exec& exec, const Problem& problem, const LabelledModel& model,
                     const std::vector<RefinedView>& refined);

/// True: the masks reject the refined contours of `model`. Two conditions must hold. First, refinement significantly
/// reduces the agreement with the masks, both from the model and from the problem's labels, because a model trained on
/// the masks agrees with them by construction. Second, the masks are reliable: aligned with the photos' edges, or the
/// model explains the photos.
bool masks_reject(const Exec& exec, const RefineSetup& setup, const LabelledModel& model,
                  const std::vector<RefinedView>& refined);

}  // namespace ngs
