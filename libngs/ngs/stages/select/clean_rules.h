#pragma once
// Debris of a scene: Gaussians that training leaves away from surfaces. Each rule is applied to the Gaussians that
// remain after the rules before it, so that haze does not connect a floater to the object. Every Gaussian has one
// reason.
//
// Distances are compared with the local spacing, not with one length: a scene is dense near the cameras and sparse far
// behind, and neither is debris. The local spacing at a Gaussian is the distance to its 8th nearest neighbour, but at
// least the median of this distance over the model, so that the surroundings of a very dense clump are no debris.
#include <array>
#include <string_view>

#include "ngs/backend/exec.h"
#include "ngs/scene/gaussian_cloud.h"
#include "ngs/stages/select/clean_options.h"

namespace ngs {

enum class Debris : std::uint8_t {
  kNone,
  kUnusable,     // non-finite or absurd values (classify())
  kTransparent,  // opacity below min_opacity
  kOversized,    // largest σ > max_size · max(distance from the middle of the bulk, radius of the bulk)
  kNeedle,       // largest σ > max_needle · middle σ; flat discs are no needles
  kIsolated,     // distance to the 8th neighbour > isolation · median local spacing of the neighbours, and > 3 σ
  kFloater       // connected component of at most floater_size Gaussians whose distance to every larger component is
                 // > isolation · local spacing there, and > 3 (σ + σ)
};
inline constexpr std::size_t kDebrisKinds = 7;
inline constexpr std::array<std::string_view, kDebrisKinds> kDebrisNames{
    "none", "unusable", "transparent", "oversized", "needle", "isolated", "floater"};

struct CleanFinding {
  std::vector<Debris> debris;                       // [N]
  std::array<std::int64_t, kDebrisKinds> counts{};  // by Debris
};

/// Depends on the set of Gaussians only, not on the order of rows. With fewer than 10 Gaussians left after the first
/// four rules the local spacing is undefined: none is isolated or a floater.
CleanFinding find_debris(const Exec& exec, const CleanOptions& options, const GaussianCloud& cloud);

}  // namespace ngs
