#pragma once
// Lens distortion of a pinhole image, in unitless coordinates: (x / z, y / z) of a point in the axes of the camera.
//   Brown, "Decentering distortion of lenses", 1966; Kannala and Brandt, "A generic camera model ...", 2006;
//   Devernay and Faugeras, "Straight lines have to be straight", 2001; models and parameter order as in COLMAP
#include <array>
#include <cmath>
#include <cstdint>

#include "ngs/math/vec.h"

namespace ngs {

struct Lens {
  enum class Kind : std::uint8_t { kPerspective, kFisheye, kFov };
  Kind kind = Kind::kPerspective;
  // With p the point after the projection of `kind`, r = |p|:
  //   p (1 + Σ radial_i r^2i) / (1 + Σ divisor_i r^2i) + tangential part + prism r²
  std::array<double, 4> radial{};
  std::array<double, 3> divisor{};
  std::array<double, 2> tangential{};  // p1, p2
  std::array<double, 2> prism{};
  double fov_rad = 0;  // of kFov, in (0, pi)
};

/// A parameter below this moves no pixel of a 64k image by more than 1e-4 px.
inline constexpr double kNegligibleDistortion = 1e-9;

/// True if the image differs from a pinhole image.
inline bool has_distortion(const Lens& lens) {
  const auto acts = [](const auto& parameters) {
    for (const double p : parameters)
      if (!(std::abs(p) < kNegligibleDistortion)) return true;
    return false;
  };
  return lens.kind != Lens::Kind::kPerspective || acts(lens.radial) || acts(lens.divisor) || acts(lens.tangential) ||
         acts(lens.prism);
}

/// Maps a point p of the pinhole image to its place in the photo.
inline Vec2<double> distort(const Lens& lens, Vec2<double> p) {
  const double radius = std::hypot(p.x, p.y);
  if (lens.kind == Lens::Kind::kFisheye && radius > 0) {
    const double shrunk = std::atan(radius) / radius;  // the angle to the axis replaces its tangent
    p.x *= shrunk;
    p.y *= shrunk;
  } else if (lens.kind == Lens::Kind::kFov && radius > 0) {
    const double shrunk = std::atan(2 * radius * std::tan(lens.fov_rad / 2)) / (radius * lens.fov_rad);
    p.x *= shrunk;
    p.y *= shrunk;
  }
  const double xx = p.x * p.x, yy = p.y * p.y, xy = p.x * p.y, r2 = xx + yy;
  const auto& [k1, k2, k3, k4] = lens.radial;
  const auto& [d1, d2, d3] = lens.divisor;
  const double radial = (1 + r2 * (k1 + r2 * (k2 + r2 * (k3 + r2 * k4)))) / (1 + r2 * (d1 + r2 * (d2 + r2 * d3)));
  const auto& [p1, p2] = lens.tangential;
  return {p.x * radial + 2 * p1 * xy + p2 * (r2 + 2 * xx) + lens.prism[0] * r2,
          p.y * radial + 2 * p2 * xy + p1 * (r2 + 2 * yy) + lens.prism[1] * r2};
}

}  // namespace ngs
