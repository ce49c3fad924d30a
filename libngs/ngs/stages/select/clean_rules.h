#pragma once
// Debris of a scene: what training leaves in a splat beside its surfaces. One rule after another looks at what those
// before it have left, so that haze does not tie a floater to the object, and every Gaussian has one reason.
//
// Distances are compared with what is usual nearby, not with one length: a scene is dense where it was photographed
// from near and sparse behind, and neither is debris. "Usual" at a Gaussian is the distance to its 8th nearest
// neighbour, and never less than the median of that over the model: what lies beside a clump denser than the scene is
// no debris either.
#include <array>
#include <string_view>

#include "ngs/backend/exec.h"
#include "ngs/scene/gaussian_cloud.h"
#include "ngs/stages/select/clean_options.h"

namespace ngs {

enum class Debris : std::uint8_t {
  kNone,
  kUnusable,     // values that are not finite or absurd (classify())
  kTransparent,  // opacity below min_opacity
  kOversized,    // largest σ > max_size · max(distance from the middle of the bulk, radius of the bulk)
  kNeedle,       // largest σ > max_needle · middle σ; flat discs are none
  kIsolated,     // its 8th neighbour is farther than isolation times the median of what is usual at its neighbours, and
                 // it does not reach so far itself: 3 σ
  kFloater       // a piece of at most floater_size Gaussians that is farther from the nearest of a larger piece than
                 // isolation times what is usual there, and does not reach so far: 3 (σ + σ)
};
inline constexpr std::size_t kDebrisKinds = 7;
inline constexpr std::array<std::string_view, kDebrisKinds> kDebrisNames{
    "none", "unusable", "transparent", "oversized", "needle", "isolated", "floater"};

struct CleanFinding {
  std::vector<Debris> debris;                       // [N]
  std::array<std::int64_t, kDebrisKinds> counts{};  // by Debris
};

/// Depends on the set of Gaussians only, not on the order of rows. Of models that are too small to say what is usual
/// (fewer than 10 Gaussians that no earlier rule takes) none is isolated or a floater.
CleanFinding find_debris(const Exec& exec, const CleanOptions& options, const GaussianCloud& cloud);

}  // namespace ngs
