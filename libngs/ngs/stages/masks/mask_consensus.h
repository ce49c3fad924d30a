#pragma once
// What the masks of some views, lifted to the splat, say about another view, and what a segmenter may be told
// of it.
#include <array>

#include "ngs/ops/splat/splat.h"
#include "ngs/scene/evidence.h"
#include "ngs/scene/scene.h"
#include "ngs/scene/view_prompt.h"

namespace ngs {

/// A view has seen a Gaussian where its mean weight over the pixels it reaches is at least this. What shines
/// through a surface that is not quite opaque must not be taken for a part of it.
inline constexpr double kLeastMeanWeight = 0.03;

/// Rendering weights of every Gaussian over the masks so far: A0 + A1, and A1 inside the object (PAPER.md
/// §5.2).
struct Lifted {
  std::vector<double> weight, object;  // [N]
  explicit Lifted(std::int64_t gaussians) : weight(std::size_t(gaussians)), object(std::size_t(gaussians)) {}
};

/// The masks of several views together. Exact: of a view that is taken out again nothing is left, not even a rounding,
/// of which the share of the object would be anything.
class LiftedSum {
 public:
  explicit LiftedSum(std::int64_t gaussians) {
    weight_.resize(std::size_t(gaussians)), object_.resize(std::size_t(gaussians));
  }
  void add(const Lifted& view);
  void remove(const Lifted& view);
  Lifted value() const;

 private:
  ExactSums weight_, object_;  // [N]
};

/// Where the object is: the mean of its Gaussians, weighted by what the masks say of them, and three times
/// their root mean square distance from it. What lies beyond is background although no mask has reached it.
struct ObjectPlace {
  Vec3<double> centre{};  // world
  double reach = 0;
};
ObjectPlace object_place(const GaussianCloud& cloud, const Lifted& lifted);

/// What one mask says, [H·W] at the camera's size. Gaussians that the view hardly sees have zeros.
Lifted lift_mask(const Exec& exec, const GaussianCloud& cloud, const Camera& camera, const SplatOptions& splat,
                 const PixelMask& mask);

/// The consensus seen from one camera. Per pixel: the share of the object among what is known, and how much
/// is known; what no mask has reached is background beyond the object's reach, else takes the side of its
/// nearest Gaussians that were reached if they agree, and is unknown if they do not; an empty place is
/// background.
struct Consensus {
  int width_px = 0, height_px = 0;
  std::vector<float> object, known;  // [H·W] in [0, 1]
  std::vector<float> alone;          // [H·W] opacity of the object without what stands before it
  std::vector<float> alpha = {};     // [H·W] opacity of the whole model
};

/// A pixel where the model is less opaque than this shows nothing: it is background, whatever its colour.
inline constexpr float kEmptyAlpha = 0.1f;

/// Makes what is empty certain background, but for strokes on the object. `alpha` [H·W].
void empty_is_background(const std::vector<float>& alpha, ViewPrompt& prompt);

/// A model, what the masks say of it, and where its object is.
struct LiftedModel {
  const GaussianCloud& cloud;
  const Lifted& lifted;
  const ObjectPlace& place;
  bool asks_neighbours = true;  // for what no mask has reached; else it is unknown
};

Consensus render_consensus(const Exec& exec, const LiftedModel& model, const Camera& camera, const SplatOptions& splat);

/// Hints: certain where at least half is known and the contour of the consensus is farther than `band_px`
/// (chessboard distance), or, within thinner parts of a clear consensus, in their middle; elsewhere the
/// likelier side. What hides the object may be a floater: there, nothing is certain. Where less than half is
/// known the side is that of `before` (an earlier mask of the view, may be empty), else background.
ViewPrompt prompt_from(const Consensus& consensus, int band_px, const PixelMask& before);

/// IoU of `mask` with the consensus over the pixels of which at least half is known and that do not hide the
/// object; 1 where both are empty there.
double agreement(const Consensus& consensus, const PixelMask& mask);

/// Pieces of the mask (4-connected) without a pixel that is certainly the object are removed, holes of less
/// than `speck_share` of the mask without certain background are filled. Without any certain object nothing
/// is removed.
PixelMask keep_seeded_pieces(const ViewPrompt& prompt, PixelMask mask, double speck_share);

struct PromptPoint {
  int x = 0, y = 0;  // px, pixel centre at + 0.5
  bool object = true;
};

/// Points for a promptable network: up to `most` per side, each the pixel deepest inside the certain region
/// outside the surroundings of those before it (SA3D's self-prompting with distance for confidence).
/// Background points lie within the surroundings of the object.
std::vector<PromptPoint> prompt_points(const ViewPrompt& prompt, int most);

/// {left, top, right, bottom} of the pixels that are likely or certainly the object, right and bottom
/// exclusive. All zero: none.
std::array<int, 4> object_box(const ViewPrompt& prompt);

}  // namespace ngs
