#pragma once
// A small random cloud and camera in any scalar type, for the splat tests.
#include <vector>

#include "ngs/core/rng.h"
#include "ngs/ops/splat/splat_engine.h"
#include "ngs/ops/splat/tile_kernels_of.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs::test {

struct SplatCase {
  int gaussians, degree;
  Camera camera;
  std::vector<double> position, rotation, log_scale, logit_opacity, sh_dc, sh_rest, label;
};

/// Gaussians in a slab, seen by an off-centre camera with a general pose; some opaque enough to reach the alpha cap,
/// some beyond the Jacobian limits, some behind the camera.
inline SplatCase splat_case(std::uint64_t seed, int gaussians, int width_px, int height_px, double spread = 1.0) {
  std::uint64_t index = 0;
  const auto uniform = [&](double lo, double hi) {
    return lo + (hi - lo) * rng_uniform(seed, RngStream::kTest, index++);
  };
  SplatCase c;
  c.gaussians = gaussians;
  c.degree = 3;
  Camera& cam = c.camera;
  cam.width_px = width_px;
  cam.height_px = height_px;
  cam.fx = 1.1 * width_px;
  cam.fy = 1.2 * width_px;
  cam.cx = 0.55 * width_px;
  cam.cy = 0.46 * height_px;
  double inv;
  const Vec4<double> q = normalised(Vec4<double>{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}, inv);
  cam.rotation = rotation_matrix(q);
  cam.translation = {uniform(-3, 3), uniform(-3, 3), uniform(-3, 3)};
  const Vec3<double> centre = cam.centre();
  for (int i = 0; i < gaussians; ++i) {
    const double z = i % 17 == 16 ? uniform(-2, 0.1) : uniform(1.5, 6);
    const Vec3<double> t{uniform(-0.6, 0.6) * spread * z, uniform(-0.5, 0.5) * spread * z, z};
    const Vec3<double> p = centre + transpose(cam.rotation) * t;
    c.position.insert(c.position.end(), {p.x, p.y, p.z});
    for (int k = 0; k < 4; ++k) c.rotation.push_back(uniform(-1, 1));
    for (int k = 0; k < 3; ++k) c.log_scale.push_back(uniform(-4, -1.2));
    c.logit_opacity.push_back(i % 5 == 4 ? uniform(4, 9) : uniform(-3, 3));
    for (int k = 0; k < 3; ++k) c.sh_dc.push_back(uniform(-1, 2));
    for (int k = 0; k < 45; ++k) c.sh_rest.push_back(uniform(-0.3, 0.3));
    for (int k = 0; k < 2; ++k) c.label.push_back(uniform(0, 1));
  }
  // Values that float represents exactly, so that the float path and the references have equal input.
  for (auto* column : {&c.position, &c.rotation, &c.log_scale, &c.logit_opacity, &c.sh_dc, &c.sh_rest, &c.label})
    for (double& x : *column) x = double(float(x));
  return c;
}

template <class S>
std::vector<S> converted(const std::vector<double>& v) {
  std::vector<S> out;
  out.reserve(v.size());
  for (const double x : v) out.push_back(S(x));
  return out;
}

/// The case as a GaussianCloud.
inline GaussianCloud float_cloud(const SplatCase& c) {
  GaussianCloud cloud;
  cloud.resize(c.gaussians, c.degree);
  cloud.position = converted<float>(c.position);
  cloud.rotation = converted<float>(c.rotation);
  cloud.log_scale = converted<float>(c.log_scale);
  cloud.logit_opacity = converted<float>(c.logit_opacity);
  cloud.sh_dc = converted<float>(c.sh_dc);
  cloud.sh_rest = converted<float>(c.sh_rest);
  return cloud;
}

/// The case's arrays in scalar S, and views of them.
template <class S>
struct SplatArrays {
  std::vector<S> position, rotation, log_scale, logit_opacity, sh_dc, sh_rest, label;
  int degree;
  explicit SplatArrays(const SplatCase& c)
      : position(converted<S>(c.position)),
        rotation(converted<S>(c.rotation)),
        log_scale(converted<S>(c.log_scale)),
        logit_opacity(converted<S>(c.logit_opacity)),
        sh_dc(converted<S>(c.sh_dc)),
        sh_rest(converted<S>(c.sh_rest)),
        label(converted<S>(c.label)),
        degree(c.degree) {}
  CloudView<S> cloud() const {
    return {std::int64_t(logit_opacity.size()),
            position.data(),
            rotation.data(),
            log_scale.data(),
            logit_opacity.data(),
            sh_dc.data(),
            sh_rest.data(),
            degree,
            15,
            nullptr,
            nullptr};
  }
  ChannelPlan<S> request(Vec3<double> background) const {
    return {true,
            true,
            {label.data(), std::int64_t(logit_opacity.size()), 2},
            {S(background.x), S(background.y), S(background.z)}};
  }
  std::vector<std::vector<S>*> parameters() {
    return {&position, &rotation, &log_scale, &logit_opacity, &sh_dc, &sh_rest, &label};
  }
};

}  // namespace ngs::test
