#include "ngs/make/synth/analytic_scene.h"

#include <algorithm>
#include <cmath>

#include "ngs/core/check.h"
#include "ngs/math/elementary.h"

namespace ngs::synth {
namespace {

constexpr double kTau = 6.283185307179586;

double box_distance(Vec3<double> p, Vec3<double> half) {
  const Vec3<double> q{std::abs(p.x) - half.x, std::abs(p.y) - half.y, std::abs(p.z) - half.z};
  const Vec3<double> outside{std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0)};
  return length(outside) + std::min(std::max({q.x, q.y, q.z}), 0.0);
}

/// A planar shape at distance `planar`, given a thickness: |z| <= half.
double extruded(double planar, double z, double half) {
  const double across = std::abs(z) - half, u = std::max(planar, 0.0), v = std::max(across, 0.0);
  return std::sqrt(u * u + v * v) + std::min(std::max(planar, across), 0.0);
}

/// Lens between two circular arcs that meet in points at x = ±half_length.
double lens_distance(double x, double y, double half_length, double half_width) {
  x = std::abs(x);
  y = std::abs(y);
  const double radius = (half_length * half_length + half_width * half_width) / (2 * half_width);
  const double depth = radius - half_width;  // the arc's centre lies at (0, -depth)
  // Beyond the line from that centre through the tip the tip is nearest, else the arc.
  if ((x - half_length) * depth > y * half_length) return std::sqrt((x - half_length) * (x - half_length) + y * y);
  return std::sqrt(x * x + (y + depth) * (y + depth)) - radius;
}

std::uint32_t lattice_hash(std::int64_t x, std::int64_t y, std::int64_t z, std::uint32_t seed) {
  std::uint64_t h = (std::uint64_t(x) * 0x9E3779B97F4A7C15ull) ^ (std::uint64_t(y) * 0xC2B2AE3D27D4EB4Full) ^
                    (std::uint64_t(z) * 0x165667B19E3779F9ull) ^ (std::uint64_t(seed) << 32);
  h = (h ^ (h >> 29)) * 0xBF58476D1CE4E5B9ull;
  h = (h ^ (h >> 32)) * 0x94D049BB133111EBull;
  return std::uint32_t(h >> 32);
}

double smooth_step(double t) { return t * t * (3 - 2 * t); }
double mix(double a, double b, double t) { return a + (b - a) * t; }

/// Weight of colour_b, in [0, 1].
double pattern_value(const Texture& t, Vec3<double> p) {
  const Vec3<double> q = t.frequency * p;
  const double wobble = value_noise(0.7 * q, t.seed + 17);
  switch (t.pattern) {
    case Pattern::kMarble: return 0.5 + 0.5 * std::sin(kTau * 0.5 * (q.x + 0.6 * q.y - 0.8 * q.z) + 3 * wobble);
    case Pattern::kStripes: return 0.5 + 0.5 * std::clamp(2.5 * std::sin(kTau * (q.z + 0.15 * wobble)), -1.0, 1.0);
    case Pattern::kChecker: {
      const double cells = std::sin(kTau / 2 * q.x) * std::sin(kTau / 2 * q.y);  // one sign per cell
      const double fade = std::abs(std::sin(kTau / 2 * (q.z + 0.25)));
      return 0.5 + 0.5 * std::clamp(6 * cells * (0.6 + 0.4 * fade), -1.0, 1.0);
    }
    case Pattern::kSpots: return std::clamp(0.5 + 2.2 * value_noise(1.6 * q, t.seed + 29), 0.0, 1.0);
  }
  return 0;
}

Solid bounded(Solid solid, double bound_radius) {
  solid.bound_radius = bound_radius;
  return solid;
}

}  // namespace

Vec3<double> normalized(Vec3<double> v) {
  const double n = length(v);
  NGS_CHECK(n > 0, "a direction must not be zero");
  return (1 / n) * v;
}

Mat3<double> frame_with_z(Vec3<double> axis) {
  const Vec3<double> z = normalized(axis);
  const Vec3<double> helper = std::abs(z.z) < 0.9 ? Vec3<double>{0, 0, 1} : Vec3<double>{1, 0, 0};
  const Vec3<double> x = normalized(cross(helper, z)), y = cross(z, x);
  return {{x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z}};
}

Mat3<double> turned_about_z(double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return {{c, s, 0, -s, c, 0, 0, 0, 1}};
}

Solid sphere(Vec3<double> centre, double radius) {
  return bounded({.kind = SolidKind::kSphere, .centre = centre, .size = {radius, 0, 0}}, radius);
}
Solid box(Vec3<double> centre, const Mat3<double>& to_local, Vec3<double> half_extent, double rounding) {
  return bounded({SolidKind::kBox, centre, to_local, half_extent, rounding}, length(half_extent));
}
Solid torus(Vec3<double> centre, const Mat3<double>& to_local, double ring_radius, double tube_radius) {
  return bounded({SolidKind::kTorus, centre, to_local, {ring_radius, tube_radius, 0}}, ring_radius + tube_radius);
}
Solid capsule(Vec3<double> from, Vec3<double> to, double radius) {
  const double half = 0.5 * length(to - from);
  return bounded({SolidKind::kCapsule, 0.5 * (from + to), frame_with_z(to - from), {radius, half, 0}}, half + radius);
}
Solid cylinder(Vec3<double> centre, const Mat3<double>& to_local, double radius, double half_length) {
  return bounded({SolidKind::kCylinder, centre, to_local, {radius, half_length, 0}},
                 portable_hypot(radius, half_length));
}
Solid blade(Vec3<double> centre, const Mat3<double>& to_local, Vec3<double> half_size) {
  return bounded({SolidKind::kBlade, centre, to_local, half_size}, length(half_size));
}

double signed_distance(const Solid& s, Vec3<double> p) {
  const Vec3<double> q = s.to_local * (p - s.centre);
  switch (s.kind) {
    case SolidKind::kSphere: return length(q) - s.size.x;
    case SolidKind::kBox: {
      const Vec3<double> core{s.size.x - s.rounding, s.size.y - s.rounding, s.size.z - s.rounding};
      return box_distance(q, core) - s.rounding;
    }
    case SolidKind::kTorus: {
      const double across = std::sqrt(q.x * q.x + q.y * q.y) - s.size.x;
      return std::sqrt(across * across + q.z * q.z) - s.size.y;
    }
    case SolidKind::kCapsule: {
      const double beyond = q.z - std::clamp(q.z, -s.size.y, s.size.y);
      return length({q.x, q.y, beyond}) - s.size.x;
    }
    case SolidKind::kCylinder: return extruded(std::sqrt(q.x * q.x + q.y * q.y) - s.size.x, q.z, s.size.y);
    case SolidKind::kBlade: return extruded(lens_distance(q.x, q.y, s.size.x, s.size.y), q.z, s.size.z);
  }
  return 0;
}

Vec3<double> surface_normal(const Solid& s, Vec3<double> p) {
  const double h = 1e-5 * s.bound_radius;
  const auto slope = [&](Vec3<double> e) { return signed_distance(s, p + e) - signed_distance(s, p - e); };
  const Vec3<double> n{slope({h, 0, 0}), slope({0, h, 0}), slope({0, 0, h})};
  return dot(n, n) > 0 ? normalized(n) : Vec3<double>{0, 0, 1};
}

double value_noise(Vec3<double> p, std::uint32_t seed) {
  const double fx = std::floor(p.x), fy = std::floor(p.y), fz = std::floor(p.z);
  const auto x = std::int64_t(fx), y = std::int64_t(fy), z = std::int64_t(fz);
  const double u = smooth_step(p.x - fx), v = smooth_step(p.y - fy), w = smooth_step(p.z - fz);
  const auto corner = [&](int i, int j, int k) {
    return double(lattice_hash(x + i, y + j, z + k, seed)) * 0x1p-31 - 1;
  };
  const auto edge = [&](int j, int k) { return mix(corner(0, j, k), corner(1, j, k), u); };
  return mix(mix(edge(0, 0), edge(1, 0), v), mix(edge(0, 1), edge(1, 1), v), w);
}

Vec3<double> albedo(const Texture& t, Vec3<double> p) {
  const double blend = pattern_value(t, p);
  const Vec3<double> q = (3.5 * t.frequency) * p;
  const double fine = t.detail * (value_noise(q, t.seed) + 0.3 * value_noise(2.0 * q, t.seed + 5));
  const auto channel = [&](double a, double b) { return std::clamp(mix(a, b, blend) + fine, 0.0, 1.0); };
  return {channel(t.colour_a.x, t.colour_b.x), channel(t.colour_a.y, t.colour_b.y),
          channel(t.colour_a.z, t.colour_b.z)};
}

}  // namespace ngs::synth
