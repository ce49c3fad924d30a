#pragma once
// After the joint optimisation: contours moved to the edges of the photos, and a model that follows them.
//                                                                     beyond the paper, where its step 6
//                                                                     ends; PAPER.md §5.10
// In every iteration the labels are rendered at every photo, also at those that have no mask; each rendered mask
// is refined to the photo's edges (ops/image/contour_refine.h); Gaussians that lie across a contour are halved; and
// labels and Gaussians are trained on the refined masks and the photos, in a window about the object. No mask
// of a held-out view is read: such a view contributes its photo alone, as it did when the model was trained.
//
// Refinement has to earn its place: where the refined masks of the training views agree significantly less with
// the views' own masks than the rendered ones did, the photos' edges are not the object's, and the model
// stays as it was. Unless the own masks are misaligned: the photos show far less contrast across their contours than
// across the refined ones. Then they are too inaccurate to judge (all of them too small, say).
#include "ngs/stages/contours/contour_options.h"
#include "ngs/stages/optimise/joint_trainer.h"
#include "ngs/stages/optimise/training_options.h"

namespace ngs {

struct ContourSetup {
  const ContourOptions& contour;
  const TrainingOptions& training;
  const Problem& problem;
  // Asked after every step, of the trainer on the windows, whose plan it may change, and of the whole model as it is
  // then; true ends the stage. May be empty.
  std::function<bool(const JointProgress&, JointTrainer&, const std::function<Solution()>& whole)> stop_after = {};
  // Told how many iterations the first refinement asks for; returns how many there is time for, 0: none, then
  // the model stays as it is. May be empty.
  std::function<int(int iterations)> iterations_allowed = {};
};

/// Goes on from the result of a method; `start` comes back where no view has a photo, where nothing is labelled, for
/// --quality draft, or where the refined masks do not agree with the given ones. Figures: contour_iterations (done),
/// contour_gaussians (rows afterwards), contour_biou_rendered and contour_biou_refined: mean boundary IoU (0.005) with
/// the training views' own masks before the first iteration; contour_contrast_given and contour_contrast_refined: mean
/// colour difference of the photos across the contours; contour_detail: 2 where photos with fewer pixels were refined
/// at twice the camera's size, else 1; contour_pictures: views trained on the model's own picture; where these were
/// tried on other views, contour_biou_pictured and contour_biou_skipped (stages/contours/photoless_views.h). Not
/// converged if it ran out of time.
Solution refine_contours(const Exec& exec, Monitor& monitor, const ContourSetup& setup, Solution start);

}  // namespace ngs
