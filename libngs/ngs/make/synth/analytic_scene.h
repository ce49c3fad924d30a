#pragma once
// A list of objects (unions of solids) in a textured room, so that no pixel is empty.
//
// Object k has the id k + 1; id 0 is the room and its furniture. World units; +z is up.
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/math/vec.h"

namespace ngs::synth {

// Solids by signed distance, and procedural solid textures, for analytic scenes.
//
// Distances are exact outside the solid (negative inside): sphere tracing never passes a surface. Lengths: world units.

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

struct Object {
  std::string name;
  std::vector<Solid> solids;
  Texture texture;
  bool visible = true;        // false: rays pass through, but it still shades what it touches
  bool is_furniture = false;  // has id 0; furniture follows all objects
};

/// The room, seen from inside: an axis-aligned box with one texture for the floor and one for the rest.
struct Room {
  Vec3<double> low{}, high{};
  Texture floor, walls;
};

struct AnalyticScene {
  std::vector<Object> objects;
  Room room;
  bool has_room = true;                  // false: rays that miss every object are black and have no depth (infinity)
  Vec3<double> light{0.45, -0.3, 0.84};  // unit, towards the light
  bool turns = false;  // the objects turn before a fixed camera: light and room follow the camera's azimuth
  double ambient = 0.4, gloss = 0;
  bool grey = false;  // images have luminance only
  bool cast_shadows = false;
  Vec3<double> focus{};   // the point that the cameras look at
  double rig_radius = 3;  // distance of the cameras from `focus`
  // The cameras' azimuths, rad: all of them, or an arc around the open side of a scene against walls.
  double open_side = -1.5707963267948966, arc = 6.283185307179586;
  int target = 0;  // index into objects
};

/// The id of objects[index] in label maps; -1 is the room.
inline std::uint16_t label_of(const AnalyticScene& scene, int index) {
  return index < 0 || scene.objects[std::size_t(index)].is_furniture ? std::uint16_t(0) : std::uint16_t(index + 1);
}

/// Number of objects without furniture: their ids are 1 to this.
inline std::size_t object_count(const AnalyticScene& scene) {
  std::size_t count = 0;
  for (const Object& object : scene.objects) count += !object.is_furniture;
  return count;
}

}  // namespace ngs::synth
