#pragma once
// An object within a ball of a large model, from strokes on a few of the cameras about it: masks of all these cameras
// and closed-form labels, in seconds.
//
// What lies outside of the ball is not looked at: a picture shows the ball's Gaussians alone, before a colour that they
// do not have, and what is empty in it is background. So a view costs what the ball holds, not what the model does.
//
// Where background strokes run all around the object in two views or more, the object is expected where all these lines
// surround it, but for the plane that it stands on, which runs on outside of them. Every view is segmented from that by
// itself, free in a band about the expected contour. The same where one plane has the strokes on the object above it
// and those on what carries it below: expected are the pieces above the plane that the object's strokes touch. Else the
// masks of the marked views are carried to the others by spread_masks(), one pass. live_mask() takes GrabCut's place in
// all.
//
// The masks of all views give the labels (PAPER.md §5.2). A Gaussian of the ball that no view sees takes the vote of
// those about it; outside of the ball all is background, and so are the pieces that no stroke on the object touches.
#include <map>

#include "ngs/core/monitor.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/scene/hand_prompt.h"
#include "ngs/scene/labels/label_columns.h"
#include "ngs/scene/scene.h"
#include "ngs/stages/live/session.h"
#include "ngs/stages/masks/mask_spread.h"
#include "ngs/stages/orbit/surface_points.h"

namespace ngs::live {

struct BallCutInput {
  const GaussianCloud& cloud;
  orbit::Ball ball;    // world, origin included
  const Scene& scene;  // cameras, and which of them supervise; photos are not looked at
  SplatOptions splat;  // for pictures at the cameras' size
  std::map<std::size_t, std::vector<HandPrompt>> marks;  // by view, at least one
  bool all_pieces = false;                               // keep the pieces that no stroke touches
  int longer_side_px = kSegmentedSide_px;                // of a view as it is segmented; a smaller one stays
};

struct BallCut {
  LabelColumns labels;  // [N]; `views` is 0 where no view sees a Gaussian of the ball, and 1 outside of the ball
  std::vector<Camera> cameras;           // of the scene, at the size that is segmented
  std::vector<SpreadView> views;         // what became of each
  std::int64_t in_ball = 0, object = 0;  // Gaussians
  std::int64_t left_out = 0;             // Gaussians of the pieces that no stroke touches
  bool is_expected = false;              // lines around the object, or a plane under it, told where it is
};

/// kNothingFound where no usable Gaussian lies in the ball, and as spread_masks(); kInconsistent as rasterise(). With
/// nothing but the cameras where `monitor` was asked to stop.
BallCut cut_in_ball(const Exec& exec, Monitor& monitor, const BallCutInput& input);

}  // namespace ngs::live
