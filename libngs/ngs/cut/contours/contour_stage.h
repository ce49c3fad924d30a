#pragma once
// Contour refinement after the joint optimisation: moves contours to the photos' edges and trains the model on them.
// An addition to the paper, after its step 6.                                                     paper.md §5.10
//
// Each iteration has four steps. The labels are rendered into every photo, including views without a mask. Each
// rendered mask is refined to the photo's edges (ops/image/contour_refine.h). Gaussians that straddle a contour are
// halved. Labels and Gaussians are trained on the refined masks and the photos, in a window about the object. No mask
// of a held-out view is read; such a view contributes only its photo, as in the model's training.
//
// Refinement is rejected if the refined masks of the training views agree significantly less with the views' own masks
// than the rendered masks did: the photos' edges are then not the object's, and the model stays unchanged. Misaligned
// masks cannot reject refinement: the photos' contrast across their contours is far lower than across the refined ones,
// so these masks are too inaccurate for a test, for example all too small.
#include "ngs/cut/contours/contour_options.h"
#include "ngs/cut/training/joint_trainer.h"
#include "ngs/cut/training/training_options.h"

namespace ngs {

struct ContourSetup {
  const ContourOptions& contour;
  const TrainingOptions& training;
  const Problem& problem;
  // Called after every step; true ends the stage. It gets the trainer of the windows, whose number of steps it may
  // change, and a function that returns the whole current model. May be empty.
  std::function<bool(const JointProgress&, JointTrainer&, const std::function<Solution()>& whole)> stop_after = {};
  // Called with the number of iterations, which the first refinement decides. May be empty.
  std::function<void(int iterations)> planned = {};
  bool half_size = false;  // train at half the size, and refine in photos of the camera's size
};

/// Continues from the result `start` of a method. Returns `start` if no view has a photo, if nothing is labelled,
/// or if the given masks reject the refined ones. The result is not converged if time ran out.
// clang-format off
/// Figures:
///   contour_iterations                    iterations done
///   contour_gaussians                     rows of the result
///   contour_biou_rendered, _refined       mean boundary IoU (0.005) with the training views' own masks, before the
///                                         first iteration
///   contour_contrast_given, _refined, _rendered
///                                         mean colour difference of the photos across the contours
///   contour_detail                        2 if small photos were refined at twice the camera's size, else 1
///   contour_pictures                      number of views trained on the model's own rendering
///   contour_biou_pictured, _skipped       results of the trial, if there was one (photoless_views.h)
// clang-format on
Solution refine_contours(const Exec& exec, Monitor& monitor, const ContourSetup& setup, Solution start);

}  // namespace ngs
