#include "ngs/make/synth/synth_render.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/core/rng.h"
#include "ngs/scene/geometry/unproject.h"

namespace ngs::synth {
namespace {

using V = Vec3<double>;
constexpr double kTouch = 1e-6;  // relative distance at which a ray hits
constexpr int kMaxSteps = 400;

struct Candidate {
  int object, solid;
};

struct RoomHit {
  double distance;
  V normal;  // inwards
};

RoomHit leave_room(const Room& room, V o, V d) {
  RoomHit hit{INFINITY, {0, 0, 1}};
  const auto face = [&](double origin, double direction, double low, double high, V axis) {
    if (direction == 0) return;
    const double t = ((direction > 0 ? high : low) - origin) / direction;
    if (t < hit.distance) hit = {t, (direction > 0 ? -1.0 : 1.0) * axis};
  };
  face(o.x, d.x, room.low.x, room.high.x, {1, 0, 0});
  face(o.y, d.y, room.low.y, room.high.y, {0, 1, 0});
  face(o.z, d.z, room.low.z, room.high.z, {0, 0, 1});
  return hit;
}

/// Solids whose bounding sphere a cone of half-angle `spread` (tan) around the ray can touch.
void collect(const AnalyticScene& scene, V o, V d, double spread, std::vector<Candidate>& out) {
  out.clear();
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    for (std::size_t k = 0; scene.objects[i].visible && k < scene.objects[i].solids.size(); ++k) {
      const Solid& s = scene.objects[i].solids[k];
      const V to = s.centre - o;
      const double along = dot(to, d), distance = length(to),
                   reach = s.bound_radius + spread * (distance + s.bound_radius);
      if (along > -reach && distance * distance - along * along <= reach * reach) out.push_back({int(i), int(k)});
    }
}

/// First hit among `candidates`, else the room, by sphere tracing: no surface is nearer than the step.
Hit trace_among(const AnalyticScene& scene, std::span<const Candidate> candidates, V o, V d) {
  const double end = scene.has_room ? leave_room(scene.room, o, d).distance : INFINITY;
  if (candidates.empty()) return {end, -1, -1};
  double near = end, far = 0;
  for (const Candidate& c : candidates) {
    const Solid& s = scene.objects[std::size_t(c.object)].solids[std::size_t(c.solid)];
    const double along = dot(s.centre - o, d);
    near = std::min(near, along - s.bound_radius);
    far = std::max(far, along + s.bound_radius);
  }
  double t = std::max(near, 0.0);
  for (int step = 0; step < kMaxSteps && t < std::min(end, far); ++step) {
    double nearest = INFINITY;
    const Candidate* hit = nullptr;
    for (const Candidate& c : candidates) {
      const double distance =
          signed_distance(scene.objects[std::size_t(c.object)].solids[std::size_t(c.solid)], o + t * d);
      if (distance < nearest) {
        nearest = distance;
        hit = &c;
      }
    }
    if (nearest < kTouch * t) return {t, hit->object, hit->solid};
    t += nearest;
  }
  return {end, -1, -1};
}

double distance_to_objects(const AnalyticScene& scene, V p, double at_most) {
  double best = at_most;
  for (const Object& object : scene.objects)
    for (const Solid& s : object.solids) {
      const V to = p - s.centre;
      const double reach = best + s.bound_radius;
      if (dot(to, to) < reach * reach) best = std::min(best, signed_distance(s, p));
    }
  return best;
}

/// Visible share of a light of 6 degrees radius at a point, by the ray's closest approach to the objects.
double lit(const AnalyticScene& scene, V p, V light) {
  constexpr double kStart = 0.01, kFar = 3, kTangent = 0.1, kStep = kTangent * kFar;  // world; kStep: upper bound
  double open = 1;
  for (double t = kStart; t < kFar && open > 0;) {
    const double distance = distance_to_objects(scene, p + t * light, kStep);
    open = std::min(open, distance / (kTangent * t));
    t += std::max(distance, kStart);
  }
  return std::clamp(open, 0.0, 1.0);
}

/// Light and room as seen from a camera at `o`. If the objects are on a turntable, both follow the camera.
struct Surroundings {
  Surroundings(const AnalyticScene& scene, V o) : light(scene.light) {
    const V from{o.x - scene.focus.x, o.y - scene.focus.y, 0};
    if (!scene.turns || !(length(from) > 0)) return;
    const double c = from.x / length(from), s = from.y / length(from);
    to_rest = {c, s, 0, -s, c, 0, 0, 0, 1};
    light = transpose(to_rest) * scene.light;
  }
  Mat3<double> to_rest{1, 0, 0, 0, 1, 0, 0, 0, 1};  // turns a point of the room back, about z
  V light;                                          // unit, towards the light
};

V shade(const AnalyticScene& scene, const Surroundings& around, const Hit& hit, V o, V d) {
  if (hit.object < 0 && !scene.has_room) return {0, 0, 0};
  const V p = o + hit.distance * d;
  V n, base;
  double gloss = 0;
  if (hit.object < 0) {
    n = leave_room(scene.room, o, d).normal;
    base = albedo(n.z > 0.5 ? scene.room.floor : scene.room.walls, around.to_rest * p);
  } else {
    const Object& object = scene.objects[std::size_t(hit.object)];
    n = surface_normal(object.solids[std::size_t(hit.solid)], p);
    base = albedo(object.texture, p);
    gloss = scene.gloss;
  }
  // Wrapped diffuse lighting: no hard terminator.
  const double shadow = scene.cast_shadows ? lit(scene, p + 0.01 * n, around.light) : 1;
  const double lambert = shadow * std::max(0.0, 0.75 * dot(n, around.light) + 0.25);
  constexpr double kContact = 0.15;  // world: range of contact shadows
  const double open = std::clamp(distance_to_objects(scene, p + kContact * n, kContact) / kContact, 0.0, 1.0);
  const double light = (scene.ambient + (1 - scene.ambient) * lambert) * (0.45 + 0.55 * open);
  const double mirror = dot(d - 2 * dot(d, n) * n, around.light), m2 = mirror * mirror;
  const double highlight = mirror > 0 ? gloss * m2 * m2 * m2 * m2 * m2 * m2 : 0;
  const auto channel = [&](double a) { return std::clamp(a * light + highlight, 0.0, 1.0); };
  return {channel(base.x), channel(base.y), channel(base.z)};
}

/// Furniture has its number among all objects, a side of the room one of six numbers after that; 0: no room.
std::uint16_t surface_of(const AnalyticScene& scene, const Hit& hit, V o, V d) {
  if (hit.object >= 0) return std::uint16_t(hit.object + 1);
  if (!scene.has_room) return 0;
  const V n = leave_room(scene.room, o, d).normal;
  const int side = n.z != 0 ? (n.z > 0 ? 1 : 2) : n.x != 0 ? (n.x > 0 ? 3 : 4) : (n.y > 0 ? 5 : 6);
  return std::uint16_t(scene.objects.size() + std::size_t(side));
}

}  // namespace

Vec3<double> ray_direction(const Camera& camera, double x, double y) {
  const V local{(x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1};
  return normalized(transpose(camera.rotation) * local);
}

Hit trace(const AnalyticScene& scene, Vec3<double> origin, Vec3<double> direction) {
  std::vector<Candidate> candidates;
  collect(scene, origin, direction, 0, candidates);
  return trace_among(scene, candidates, origin, direction);
}

SynthView render_view(const Exec& exec, const AnalyticScene& scene, const Camera& camera, int samples_per_side) {
  const int w = camera.width_px, h = camera.height_px;
  SynthView view{ImageF(w, h, 3), ImageU16(w, h, 1), ImageU16(w, h, 1), ImageF(w, h, 1), ImageF(w, h, 1)};
  const V o = camera.centre(), forward{camera.rotation(2, 0), camera.rotation(2, 1), camera.rotation(2, 2)};
  const Surroundings around(scene, o);
  const double spread = 0.75 / std::min(camera.fx, camera.fy);  // half a pixel's diagonal, rounded up
  for_each_task(exec, h, [&](std::int64_t row) {
    const int y = int(row);
    std::vector<Candidate> candidates;
    for (int x = 0; x < w; ++x) {
      const V middle = ray_direction(camera, x + 0.5, y + 0.5);
      collect(scene, o, middle, spread, candidates);
      const Hit centre = trace_among(scene, candidates, o, middle);
      view.label.at(x, y) = label_of(scene, centre.object);
      view.surface.at(x, y) = surface_of(scene, centre, o, middle);
      view.depth.at(x, y) = float(centre.distance * dot(middle, forward));
      if (candidates.empty() && !scene.has_room) continue;
      V sum{0, 0, 0};
      int covered = 0;
      for (int j = 0; j < samples_per_side; ++j)
        for (int i = 0; i < samples_per_side; ++i) {
          const V d = ray_direction(camera, x + (i + 0.5) / samples_per_side, y + (j + 0.5) / samples_per_side);
          const Hit hit = trace_among(scene, candidates, o, d);
          covered += hit.object == scene.target;
          sum = sum + shade(scene, around, hit, o, d);
        }
      const double share = 1.0 / (samples_per_side * samples_per_side);
      if (scene.grey) sum.x = sum.y = sum.z = 0.299 * sum.x + 0.587 * sum.y + 0.114 * sum.z;  // Rec. 601 luma
      view.colour.at(x, y, 0) = float(share * sum.x);
      view.colour.at(x, y, 1) = float(share * sum.y);
      view.colour.at(x, y, 2) = float(share * sum.z);
      view.coverage.at(x, y) = float(share * covered);
    }
  });
  return view;
}

std::vector<SparsePoint> sample_points(std::span<const Camera> cameras, std::span<const SynthView> views, int count,
                                       std::uint64_t seed) {
  NGS_CHECK(cameras.size() == views.size() && !views.empty(), "sample_points: one view per camera");
  constexpr double kNoisePx = 0.3;
  std::uint64_t draw = 0;
  const auto uniform = [&] { return rng_uniform(seed, RngStream::kSynth, (1ull << 40) + draw++); };
  const auto normal = [&] { return rng_normal(seed, RngStream::kSynth, (1ull << 41) + draw++); };
  std::vector<SparsePoint> points(static_cast<std::size_t>(count));
  for (SparsePoint& point : points) {
    const std::size_t source = std::min(views.size() - 1, std::size_t(uniform() * double(views.size())));
    const Camera& camera = cameras[source];
    const int px = std::min(camera.width_px - 1, int(uniform() * camera.width_px));
    const int py = std::min(camera.height_px - 1, int(uniform() * camera.height_px));
    const double z = double(views[source].depth.at(px, py));
    const V exact = unproject(camera, px + 0.5, py + 0.5, z);
    for (int c = 0; c < 3; ++c) point.rgb[c] = std::uint8_t(std::lround(255 * views[source].colour.at(px, py, c)));
    const double error = kNoisePx * z / camera.fx;
    const double nx = normal(), ny = normal(), nz = normal();
    point.position = exact + error * V{nx, ny, nz};
    for (std::size_t v = 0; v < cameras.size(); ++v) {
      const std::optional<V> q = cameras[v].project(exact);
      if (!q) continue;
      // Occlusion test against the depth of that pixel, with 2 % tolerance for slanted surfaces.
      if (q->z > 1.02 * double(views[v].depth.at(int(q->x), int(q->y)))) continue;
      const double ox = normal(), oy = normal();
      point.track.push_back({int(v), q->x + kNoisePx * ox, q->y + kNoisePx * oy});
    }
  }
  return points;
}

}  // namespace ngs::synth
