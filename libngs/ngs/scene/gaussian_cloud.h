#pragma once
// A 3D Gaussian splatting model in the encoding of its PLY, as a structure of arrays.
#include <array>
#include <cstdint>
#include <vector>

#include "ngs/math/vec.h"

namespace ngs {

/// Number of SH coefficients beyond the constant one: 0, 3, 8, 15 for degree 0..3.
inline constexpr int sh_rest_count(int degree) { return (degree + 1) * (degree + 1) - 1; }

struct GaussianCloud {
  std::array<double, 3> origin{};    // world = origin + position; non-zero only for `double` PLYs far from 0
  std::vector<float> position;       // [N, 3] world, relative to origin
  std::vector<float> rotation;       // [N, 4] w x y z as stored; used normalised (a zero quaternion: identity)
  std::vector<float> log_scale;      // [N, 3] ln world
  std::vector<float> logit_opacity;  // [N]
  std::vector<float> sh_dc;          // [N, 3] rgb = colour_of_dc(sh_dc), math/sh.h
  std::vector<float> sh_rest;        // [N, sh_rest_count(sh_degree), 3]; the PLY is channel-major, transposed on load
  int sh_degree = 0;                 // 0..3
  bool antialiased = false;          // trained with the Mip-Splatting opacity compensation (PLY comment)
  std::vector<std::uint8_t> usable;  // [N] 0: non-finite or absurd scale; ignored by the maths, written to every output

  std::int64_t size() const { return std::int64_t(logit_opacity.size()); }
  int rest_count() const { return sh_rest_count(sh_degree); }
  void resize(std::int64_t n, int degree) {
    const auto count = std::size_t(n);
    sh_degree = degree;
    position.resize(count * 3);
    rotation.resize(count * 4);
    log_scale.resize(count * 3);
    logit_opacity.resize(count);
    sh_dc.resize(count * 3);
    sh_rest.resize(count * std::size_t(sh_rest_count(degree)) * 3);
    usable.resize(count, 1);
  }
};

inline Vec3<double> world_position(const GaussianCloud& cloud, std::size_t i) {
  const float* p = &cloud.position[3 * i];
  return Vec3<double>{cloud.origin[0], cloud.origin[1], cloud.origin[2]} + Vec3<double>{p[0], p[1], p[2]};
}

/// ∂L/∂(each column of GaussianCloud), same shapes.
struct CloudGradients {
  std::vector<float> position, rotation, log_scale, logit_opacity, sh_dc, sh_rest;
  std::vector<float> label;           // [N, K] ∂L/∂(label channel values)
  std::vector<float> mean_px;         // [N, 2] ∂L/∂(projected mean), px^-1, for densification
  std::vector<std::uint8_t> visible;  // [N] 1: listed for a tile of this view; may be occluded

  void resize(std::size_t n, std::size_t rest_values, std::size_t labels) {
    position.resize(n * 3);
    rotation.resize(n * 4);
    log_scale.resize(n * 3);
    logit_opacity.resize(n);
    sh_dc.resize(n * 3);
    sh_rest.resize(rest_values * n);
    mean_px.resize(n * 2);
    visible.resize(n);
    label.resize(n * labels);
  }
};

/// Counts of the Gaussians that `usable` excludes, by the first reason found.
struct CloudHealth {
  std::int64_t total = 0, non_finite = 0, absurd_scale = 0, zero_rotation = 0;
  std::int64_t excluded() const { return non_finite + absurd_scale; }
};

/// Fills `cloud.usable` and counts. Excluded: NaN or ±Inf in position, rotation or colour; NaN opacity (±Inf is legal:
/// exactly opaque or absent); NaN scale; log_scale = -Inf or > `kMaxLogScale`. A zero quaternion is usable and means
/// the identity.
CloudHealth classify(GaussianCloud& cloud);
inline constexpr float kMaxLogScale = 40.f;  // e^40 world units: beyond it the covariance overflows float

}  // namespace ngs
