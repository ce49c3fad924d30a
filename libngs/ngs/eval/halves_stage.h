#pragma once
// Scores of the two halves of a cut against their truth: the object alone from all sides, and the room behind it. Stage
// of ngs-eval --halves; the truth is that of ngs-synth --truth halves. Definitions: docs/decisions/both-halves.md#079.
#include <cstdint>
#include <span>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/scene/camera.h"
#include "ngs/scene/rendered_view.h"
#include "ngs/scene/view_prompt.h"
#include "ngs/scene/views.h"

namespace ngs {

/// Errors no farther than this from the object's contour are contour errors, which IoU measures.
inline constexpr int kContourSlack_px = 2;
/// A direction is seen if a camera of the photos is within this angle of it.
inline constexpr double kSeenAngle_deg = 30;

/// The object alone in one view, over black.
struct AloneScore {
  double iou = 0, biou = 0;     // of alpha > 1/2 and the truth's alpha >= 1/2; boundary IoU at 0.02 of the diagonal
  double psnr_db = 0;           // of colour, at the pixels within kContourSlack_px of the truth
  double spikes_px = 0;         // pixels with alpha > 1/2 farther than kContourSlack_px from every pixel of the truth
  double longest_spike_px = 0;  // largest such distance
  double holes_px = 0;          // pixels with alpha < 1/2 more than kContourSlack_px inside the truth
};

/// `rendered`: colour over black and alpha. `colour` [H, W, 3] over black and `alpha` [H, W, 1] are the truth. Throws
/// kBadInput if no pixel of the truth shows the object, and kNumeric for alphas outside [0, 1].
AloneScore score_alone(const Exec& exec, const RenderedView& rendered, const ImageF& colour, const ImageF& alpha);

/// Means of all members. Empty: all 0.
AloneScore mean_of(std::span<const AloneScore> scores);

/// Angle, degrees, between the direction of `camera` and that of the nearest one of `others`, seen from `centre`.
/// 180 if there are no others.
double angle_to_nearest(Vec3<double> centre, const Camera& camera, std::span<const Camera> others);

/// The background in one view.
struct HoleView {
  Camera camera;
  ImageF rendered, truth;  // [H, W, 3]
  ImageF depth;            // [H, W, 1] camera z of the truth
  PixelMask hole;          // [H·W] nonzero where the object hides the room
};

struct HoleScore {
  double psnr_db = 0, ssim = 0;  // at the pixels of the hole
};
/// The hole must not be empty.
HoleScore score_hole(const Exec& exec, const HoleView& view);

/// How much the filled hole changes from view to view. It is measured at points of the true surface, one per 4x4 pixels
/// of each hole, that lie in the holes of at least two views. In each of these views a point's error is the rendered
/// minus the true colour of its pixel. Its flicker is the standard deviation of that error over the views, root mean
/// square over R, G, B.
struct Flicker {
  double mean = 0;  // over the points; [0, 1]
  std::int64_t points = 0;
};
Flicker flicker(const Exec& exec, std::span<const HoleView> views);

struct OutsideChange {
  double mean = 0, most = 0;  // absolute difference of colours, over pixels and channels; [0, 1]
};
/// `full[i]`: the render of the uncut model in view i. Pixels within 0.02 of the diagonal from the hole do not count.
OutsideChange outside_change(std::span<const HoleView> views, std::span<const ImageF> full);

}  // namespace ngs
