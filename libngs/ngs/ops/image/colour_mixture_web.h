#pragma once
// Mixtures of five normal distributions of colours, as GrabCut learns them: one for each side.
#include <span>

#include "ngs/ops/image/colour_cut.h"

namespace ngs {

using Rgb = std::array<std::uint8_t, 3>;

class ColourMixture {
 public:
  /// Learns from colours, each with the component that it belongs to. No colours: every density is 0.
  void learn(std::span<const Rgb> colours, std::span<const std::uint8_t> component);

  double density(const Rgb& colour) const;
  /// The component with the highest density, whatever its weight.
  std::uint8_t component_of(const Rgb& colour) const;

 private:
  struct Component {
    double weight = 0;  // 0: no colours
    std::array<double, 3> mean{};
    std::array<double, 9> covariance{}, inverse{};  // row by row
    double determinant = 0;

    double density(const Rgb& colour) const;
    void invert();
  };
  std::array<Component, kMixtureComponents> components_;
};

/// The pseudo-random numbers of OpenCV, multiply with carry: clusters begin with the same colours.
class ClusterRandom {
 public:
  explicit ClusterRandom(std::uint64_t state) : state_(state) {}
  std::uint32_t next();
  double unit();  // in [0, 1)

 private:
  std::uint64_t state_;
};

/// The cluster of each colour, [0, kMixtureComponents): ten rounds of k-means from centres that are drawn far apart
/// (k-means++). At least kMixtureComponents colours. Same clusters as OpenCV's.
std::vector<std::uint8_t> colour_clusters(std::span<const Rgb> colours, ClusterRandom& random);

}  // namespace ngs
