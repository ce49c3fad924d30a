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
#include "ngs/options/field.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs {

struct CleanOptions {
  double min_opacity = 0.005;
  double max_size = 0.3;
  double max_needle = 100;
  double isolation = 10;
  int floater_size = 200;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.min_opacity,
          Field<double>{"min_opacity", "",
                        "Near-transparent: opacity below this, the lowest that training keeps; 0: off", 0.0, 1.0});
    visit(self.max_size, Field<double>{"max_size", "",
                                       "Oversized: largest standard deviation above this fraction of the distance from "
                                       "the scene centre (inside the bulk of the scene: of its radius); 0: off",
                                       0.0, 1e9});
    visit(self.max_needle,
          Field<double>{"max_needle", "",
                        "Needle: largest standard deviation above this multiple of the middle one; 0: off", 0.0, 1e9});
    visit(self.isolation,
          Field<double>{
              "isolation", "",
              "Isolated or floater: distance to the others above this multiple of the usual local distance; 0: off",
              0.0, 1e9});
    visit(self.floater_size, Field<int>{"floater_size", "Gaussians",
                                        "Floaters: separate components of at most this many; 0: off", 0, 1 << 30});
  }
};

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
