#pragma once
// Solids by signed distance, and procedural solid textures, for analytic scenes.
//
// Every distance is exact outside its solid (negative inside), so sphere tracing never passes a surface. Lengths are in
// world units.
#include <cstdint>

#include "ngs/math/vec.h"

namespace ngs::synth {

enum class SolidKind : std::uint8_t { kSphere, kBox, kTorus, kCapsule, kCylinder, kBlade };

struct Solid {
  SolidKind kind = SolidKind::kSphere;
  Vec3<double> centre{};
  Mat3<double> to_local{{1, 0, 0, 0, 1, 0, 0, 0, 1}};  // world -> local, orthonormal
  // sphere: radius · box: half extents, corners rounded by `rounding` · torus: ring radius, tube radius (axis local z)
  // capsule, cylinder: radius, half length along local z (capsule: between the cap centres)
  // blade: half length (x), half width (y), half thickness (z) of a pointed leaf
  Vec3<double> size{};
  double rounding = 0;
  double bound_radius = 0;  // of a sphere around `centre` that contains the solid
};

Solid sphere(Vec3<double> centre, double radius);
Solid box(Vec3<double> centre, const Mat3<double>& to_local, Vec3<double> half_extent, double rounding);
Solid torus(Vec3<double> centre, const Mat3<double>& to_local, double ring_radius, double tube_radius);
Solid capsule(Vec3<double> from, Vec3<double> to, double radius);
Solid cylinder(Vec3<double> centre, const Mat3<double>& to_local, double radius, double half_length);
Solid blade(Vec3<double> centre, const Mat3<double>& to_local, Vec3<double> half_size);

double signed_distance(const Solid& solid, Vec3<double> p);
/// Unit outward normal near the surface (central differences of the distance).
Vec3<double> surface_normal(const Solid& solid, Vec3<double> p);

enum class Pattern : std::uint8_t { kMarble, kStripes, kChecker, kSpots };

/// Smooth variation between two colours plus fine detail.
struct Texture {
  Pattern pattern = Pattern::kMarble;
  Vec3<double> colour_a{0.8, 0.8, 0.8}, colour_b{0.2, 0.2, 0.2};  // [0, 1]
  double frequency = 2;                                           // cycles per world unit of the pattern
  double detail = 0.12;                                           // amplitude of the fine noise, at 3.5x the frequency
  std::uint32_t seed = 0;
};

/// Albedo at `p` (texture coordinates), each channel in [0, 1].
Vec3<double> albedo(const Texture& texture, Vec3<double> p);

/// Value noise in [-1, 1], C1, wavelength about 2 lattice units.
double value_noise(Vec3<double> p, std::uint32_t seed);

Vec3<double> normalized(Vec3<double> v);
inline const Mat3<double> kUpright{{1, 0, 0, 0, 1, 0, 0, 0, 1}};
/// Rows: an orthonormal frame whose third axis is `axis`.
Mat3<double> frame_with_z(Vec3<double> axis);
/// world -> local of a solid turned by `angle_rad` about +z.
Mat3<double> turned_about_z(double angle_rad);

}  // namespace ngs::synth
