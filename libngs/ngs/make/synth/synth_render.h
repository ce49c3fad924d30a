#pragma once
// Exact renders of an analytic scene: colour by supersampling, everything else by the ray through the pixel centre.
#include <span>

#include "ngs/backend/exec.h"
#include "ngs/make/synth/synth_scene.h"
#include "ngs/scene/sparse_points.h"
#include "ngs/scene/views.h"

namespace ngs::synth {

struct SynthView {
  ImageF colour;   // [H, W, 3] in [0, 1], mean over samples_per_side² rays
  ImageU16 label;  // [H, W] id of the object at the pixel centre; 0: room or furniture
  ImageU16
      surface;  // [H, W] the same where it is > 0, else an id above all objects: of furniture, or of a side of the room
  ImageF coverage;  // [H, W] fraction of the colour rays that hit the target
  ImageF depth;     // [H, W] camera z at the pixel centre
};

SynthView render_view(const Exec& exec, const AnalyticScene& scene, const Camera& camera, int samples_per_side);

struct Hit {
  double distance = 0;  // along the unit direction
  int object = -1;      // -1: the room
  int solid = -1;
};

/// First surface along a ray that starts inside the room and outside every solid. A ray that misses a surface by
/// less than 1e-6 of its distance counts as a hit (at 1000 px focal length: 1/1000 px).
Hit trace(const AnalyticScene& scene, Vec3<double> origin, Vec3<double> direction);

/// Unit world direction of the ray through image point (x, y), px.
Vec3<double> ray_direction(const Camera& camera, double x, double y);

/// `count` points on the surfaces, each through a random pixel of a random view, with noise as in structure from
/// motion: 0.3 px in every observation and the corresponding distance in space. Deterministic in `seed`.
std::vector<SparsePoint> sample_points(std::span<const Camera> cameras, std::span<const SynthView> views, int count,
                                       std::uint64_t seed);

}  // namespace ngs::synth
