#pragma once
// Cuts an object within a ball of a large model from strokes on a few of the cameras around it: masks of all these
// cameras and closed-form labels, in seconds.
//
// Only the Gaussians in the ball are rendered, over a colour that they do not have; empty pixels are background. The
// cost of a view therefore depends on the Gaussians in the ball, not on the model.
//
// The expected object is found in one of two ways:
//   - In two or more views a background stroke surrounds the object: the Gaussians within all these strokes.
//     The supporting plane, which continues outside of the strokes, is left out.
//   - A plane separates the strokes on the object (above) from those on the background (below): the pieces above the
//     plane that strokes on the object touch.
// Each view is then segmented independently, with a free band around the expected contour. In all other cases
// spread_masks() carries the masks of the marked views to the others in one pass. All masks come from live_mask().
//
// If fewer than half of the views get a mask in this way, the object is so dense that its Gaussians hide one another.
// The masks are then carried again, and hidden Gaussians get the side of their neighbours. Gaussians in the supporting
// plane are removed from the object, and pieces that three masks show are kept like touched ones.
//
// The masks of all views give the labels (paper.md §5.2). A Gaussian of the ball that is hidden in all views is object
// if the majority of its neighbours is, or if most of the little weight it has lies inside the masks. Everything
// outside the ball is background, as are pieces that no stroke on the object touches.
#include <map>

#include "ngs/core/monitor.h"
#include "ngs/cut/masks/mask_spread.h"
#include "ngs/interactive/session.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/scene/geometry/surface_points.h"
#include "ngs/scene/hand_prompt.h"
#include "ngs/scene/labels/label_column.h"
#include "ngs/scene/scene.h"

namespace ngs::live {

struct BallCutInput {
  const GaussianCloud& cloud;
  orbit::Ball ball;                                      // world, origin included
  const Scene& scene;                                    // cameras and their split; photos are not used
  SplatOptions splat;                                    // for renders at the cameras' size
  std::map<std::size_t, std::vector<HandPrompt>> marks;  // by view, at least one
  bool all_pieces = false;                               // keep the pieces that no stroke touches
  int longer_side_px = kSegmentedSide_px;                // of a segmented view; smaller views keep their size
};

struct BallCut {
  LabelColumns labels;  // [N]; `views` is 0 for Gaussians of the ball visible in no view, and 1 outside the ball
  std::vector<Camera> cameras;           // of the scene, at the segmented size
  std::vector<SpreadView> views;         // result of each view
  std::int64_t in_ball = 0, object = 0;  // numbers of Gaussians
  std::int64_t removed = 0;              // Gaussians of the pieces that no stroke touches
  std::int64_t needles = 0;              // Gaussians that stick out of the object (select/touched_pieces.h)
  bool is_expected = false;              // the expected object was found from strokes around it or a plane under it
};

/// Throws kNothingFound if no usable Gaussian lies in the ball and as spread_masks(), kInconsistent as rasterise().
/// After a stop request to `monitor` the labels are empty.
BallCut cut_in_ball(const Exec& exec, Monitor& monitor, const BallCutInput& input);

}  // namespace ngs::live
