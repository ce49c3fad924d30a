#pragma once
// Scalar maths of rays and depth windows.                                                  Eqs. (6)-(7)
#include "ngs/ops/field/sample_grid_kernels.h"

namespace ngs {

/// The unit direction, in world axes, of the ray through pixel position (u, v).                 Eq. (6)
///
///   d = Rᵀ normalise(x, y, 1),   x = (u - cx) / fx, y = (v - cy) / fy,   R: world -> camera
///
/// The paper calls R camera -> world but transposes it; with R world -> camera the formula is right (C11). `cosine`: of
/// the angle to the optical axis, z-depth = cosine · distance along the ray.
template <class T>
NGS_HD Vec3<T> ray_direction(const Mat3<T>& rotation, T x, T y, T& cosine) {
  using std::sqrt;
  cosine = T(1) / sqrt(x * x + y * y + T(1));
  return cosine * (transpose(rotation) * Vec3<T>{x, y, T(1)});
}

/// The sampled part of a ray: distances from the camera centre, 0 < near <= far.
template <class T>
struct DepthWindow {
  T near, far;
};

/// [t - h, t + h] with h = max(span·t, epsilon), both ends clamped to >= `nearest`.             Eq. (7)
template <class T>
NGS_HD DepthWindow<T> depth_window(T centre, T span, T epsilon, T nearest) {
  const T half = max2(span * centre, epsilon);
  return {max2(centre - half, nearest), max2(centre + half, nearest)};
}

/// Distance of sample k of K: near to far inclusive, δ_k = -1 + 2k / (K - 1); K = 1: the middle (C9).
template <class T>
NGS_HD T sample_distance(DepthWindow<T> window, int k, int samples) {
  if (samples == 1) return T(0.5) * (window.near + window.far);
  const T t = T(k) / T(samples - 1);
  return (T(1) - t) * window.near + t * window.far;
}

/// Δ of Eq. (1): the length of ray per sample (C15).
template <class T>
NGS_HD T sample_spacing(DepthWindow<T> window, int samples) {
  return (window.far - window.near) / T(samples > 1 ? samples - 1 : 1);
}

struct RayOptions {
  int samples = 8;              // per ray, >= 1
  double depth_span = 0.1;      // half window / distance
  double depth_epsilon = 1e-4;  // minimum half window, world
  double mean_distance = 0;     // > 0, world: centre of the window without a rendered depth
  double near_z = kNearZ;       // least camera z of a sample, world
};

/// The ray through a node of the grid.
struct RayNode {
  Vec3<double> direction;
  double u, v, cosine;
};
NGS_HD inline RayNode ray_node(const RayCamera& camera, const PixelGrid& grid, std::int64_t ray) {
  RayNode node;
  node.u = grid.x(int(ray % grid.cols));
  node.v = grid.y(int(ray / grid.cols));
  node.direction =
      ray_direction(camera.rotation, (node.u - camera.cx) / camera.fx, (node.v - camera.cy) / camera.fy, node.cosine);
  return node;
}

/// Depth and alpha at a node.
struct NodeDepth {
  double depth, alpha;
};

/// Planes of a rendered view, [H, W] each, or their values at the nodes; null: none.
struct DepthPlanes {
  const float *depth = nullptr, *alpha = nullptr;
  int width_px = 0, height_px = 0;
  const NodeDepth* node = nullptr;  // [R] instead of planes

  /// Expected distance along ray r; 0 if alpha <= `least_alpha` there.
  NGS_HD double expected_distance(const RayNode& ray, std::int64_t r, double least_alpha) const {
    if (node == nullptr && (depth == nullptr || alpha == nullptr)) return 0;
    const double covered = node ? node[r].alpha : at(alpha, ray);
    if (!(covered > least_alpha)) return 0;
    return (node ? node[r].depth : at(depth, ray)) / covered / ray.cosine;
  }
  NGS_HD NodeDepth read(const RayNode& ray) const { return {at(depth, ray), at(alpha, ray)}; }

 private:
  NGS_HD double at(const float* plane, const RayNode& node) const {
    return read_bilinear(node.u, node.v, width_px, height_px,
                         [&](int x, int y) { return plane[static_cast<std::int64_t>(y) * width_px + x]; });
  }
};

/// Index r reads the planes at node r.
struct ReadNodes {
  static constexpr const char* kName = "read_nodes";
  RayCamera camera;
  PixelGrid grid;
  DepthPlanes map;
  NodeDepth* node;  // [R] out
  NGS_HD void operator()(std::int64_t r) const { node[r] = map.read(ray_node(camera, grid, r)); }
};

/// Arrays of RayQueries; null `pixel` and `depth`: not wanted.
struct RayArrays {
  float *pixel = nullptr, *direction = nullptr, *near = nullptr, *far = nullptr, *spacing = nullptr,
        *position = nullptr, *depth = nullptr;
};

/// Index r writes ray r.
struct SampleRay {
  static constexpr const char* kName = "sample_ray";
  static constexpr double kCovered = 0.5;  // alpha above which a pixel's own depth is used
  RayCamera camera;
  PixelGrid grid;
  RayOptions options;
  DepthPlanes map;
  RayArrays out;

  NGS_HD void operator()(std::int64_t r) const {
    const RayNode node = ray_node(camera, grid, r);
    double distance = map.expected_distance(node, r, kCovered);
    if (!(distance > options.near_z)) distance = options.mean_distance;
    const DepthWindow<double> window =
        depth_window(distance, options.depth_span, options.depth_epsilon, options.near_z / node.cosine);
    if (out.pixel) {
      out.pixel[r * 2] = float(node.u);
      out.pixel[r * 2 + 1] = float(node.v);
    }
    store(out.direction + r * 3, node.direction);
    out.near[r] = float(window.near);
    out.far[r] = float(window.far);
    out.spacing[r] = float(sample_spacing(window, options.samples));
    for (int k = 0; k < options.samples; ++k) {
      const double t = sample_distance(window, k, options.samples);
      const std::int64_t at = r * options.samples + k;
      if (out.depth) out.depth[at] = float(t);
      store(out.position + at * 3, camera.centre + t * node.direction);
    }
  }

 private:
  NGS_HD static void store(float* p, Vec3<double> v) {
    p[0] = float(v.x);
    p[1] = float(v.y);
    p[2] = float(v.z);
  }
};

/// Index r writes on[r]: 1 if the view shows only background at the node or its expected depth lies in the ray's
/// window.
struct RayOnSurface {
  static constexpr const char* kName = "ray_on_surface";
  static constexpr double kEmptyAlpha = 1e-3;  // alpha up to which the view shows only background
  RayCamera camera;
  PixelGrid grid;
  DepthPlanes map;
  const float *near, *far;  // [R]
  std::uint8_t* on;         // [R] out

  NGS_HD void operator()(std::int64_t r) const {
    const double distance = map.expected_distance(ray_node(camera, grid, r), r, kEmptyAlpha);
    on[r] = distance == 0 || (distance >= double(near[r]) && distance <= double(far[r]));
  }
};

}  // namespace ngs
