#pragma once
// Consensus: masks of some views are lifted to the splat, rendered into another, and turned into hints for a segmenter.
#include <array>

#include "ngs/ops/splat/splat.h"
#include "ngs/scene/evidence.h"
#include "ngs/scene/scene.h"
#include "ngs/scene/view_prompt.h"

namespace ngs {

/// A Gaussian is visible in a view if its mean weight over the pixels that it covers is at least this. Gaussians that
/// only show through a surface that is not fully opaque must not count as part of it.
inline constexpr double kMinMeanWeight = 0.03;

/// Position and extent of the object: the mean of its Gaussians, weighted by their weight inside the masks, and three
/// times their RMS distance from it. Gaussians farther away are background even if no mask shows them.
struct ObjectPlace {
  Vec3<double> centre{};  // world
  double reach = 0;
};
ObjectPlace object_place(const GaussianCloud& cloud, const WeightSums<>& lifted);

/// Lifts one mask [H·W] of the camera's size: the sums of the Gaussians that are visible by kMinMeanWeight.
ViewSums lift_mask(const Exec& exec, const GaussianCloud& cloud, const Camera& camera, const SplatOptions& splat,
                   const PixelMask& mask);

/// The consensus rendered from one camera: per pixel the known fraction, and the object's share of the known part. A
/// Gaussian visible in no mask is background beyond ObjectPlace::reach. Within the reach it gets the side of its
/// nearest visible Gaussians if they agree, and is unknown otherwise. Empty space is known background.
struct Consensus {
  int width_px = 0, height_px = 0;
  std::vector<float> object, known;  // [H·W] in [0, 1]
  std::vector<float> alone;          // [H·W] opacity of the object rendered without occluders
  std::vector<float> alpha = {};     // [H·W] opacity of the full model
};

/// A pixel where the model is less opaque than this is empty: it is background, whatever its colour.
inline constexpr float kEmptyAlpha = 0.1f;

/// Makes empty pixels certain background, in a prompt except under strokes on the object. `alpha` [H·W].
void empty_is_background(const std::vector<float>& alpha, ViewPrompt& prompt);
void empty_is_background(const std::vector<float>& alpha, PixelMask& mask);

/// Hand-made marks override the consensus.
void keep_strokes(const ViewPrompt& by_hand, ViewPrompt& prompt);

struct LiftedModel {
  const GaussianCloud& cloud;
  const WeightSums<>& lifted;  // of one object
  const ObjectPlace& place;
  bool use_neighbours = true;  // for Gaussians visible in no mask; otherwise they are unknown
};

Consensus render_consensus(const Exec& exec, const LiftedModel& model, const Camera& camera, const SplatOptions& splat);

/// Hints from a consensus.
///   - Certain: at least half is known and the contour is farther than `band_px` (chessboard distance).
///     Also certain: the middle of a thinner part with a clear consensus.
///   - Likely: all other pixels, with the likelier side. This includes occluders of the object, which may be floaters.
///   - If less than half is known, the side is that of `before` (an earlier mask of the view, may be empty), else
///     background.
ViewPrompt prompt_from(const Consensus& consensus, int band_px, const PixelMask& before);

/// IoU of `mask` with the consensus over the pixels that are at least half known and do not occlude the object; 1 if
/// both are empty there.
double agreement(const Consensus& consensus, const PixelMask& mask);

/// Removes 4-connected components of the mask without a certain object pixel, and fills holes that are smaller than
/// `speck_share` of the mask and contain no certain background. Without any certain object pixel nothing is removed.
PixelMask keep_seeded_pieces(const ViewPrompt& prompt, PixelMask mask, double speck_share);

struct PromptPoint {
  int x = 0, y = 0;  // px, pixel centre at + 0.5
  bool object = true;
};

/// Points for a promptable network, up to `max_points` per side. Each is the pixel deepest inside the certain region,
/// outside a square around every earlier point (SA3D's self-prompting, with distance as confidence). Background points
/// lie near the object's box.
std::vector<PromptPoint> prompt_points(const ViewPrompt& prompt, int max_points);

/// {left, top, right, bottom} of the likely or certain object pixels, right and bottom exclusive. All zero if none.
std::array<int, 4> object_box(const ViewPrompt& prompt);

}  // namespace ngs
