#pragma once
// Ground truth of a cut: the room without the target, and the target alone, with cameras that the photos do not have.
#include <vector>

#include "ngs/make/synth/synth_scene.h"

namespace ngs::synth {

/// The scene without its target and the target's contact shadows. Ids of the other objects are unchanged.
AnalyticScene without_target(AnalyticScene scene);

/// The target alone, shaded as in the photos. Everything else is black with coverage 0, so that a view's colour is the
/// target over black, and its coverage the target's alpha. Cameras may be outside of the room.
AnalyticScene target_alone(AnalyticScene scene);

struct TargetBall {
  Vec3<double> centre{};
  double radius = 0;
};
TargetBall target_ball(const AnalyticScene& scene);

inline constexpr int kTargetViews = 64;
/// Cameras on a Fibonacci sphere around the target, below included, named 0000.png, 0001.png, …: at the rig's distance,
/// or farther if the target would not fit into the image.
std::vector<Camera> target_rig(const Recipe& recipe, const AnalyticScene& scene);

/// Number of cameras of each kind in hole_rig().
inline constexpr int kHoleViews = 12;
/// Cameras that look at the place of the target: above-00.png, … from an elevation of 60° to 80°, near-00.png, … from
/// 1.6 radii of the target. All are at least 0.3 from every solid and wall. Throws kUsage if there is no place for
/// them.
std::vector<Camera> hole_rig(const Recipe& recipe, const AnalyticScene& scene);

}  // namespace ngs::synth
