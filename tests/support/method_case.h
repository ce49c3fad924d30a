#pragma once
// A small scene with several views, disc masks and noisy photos: input for the methods of ngs-joint.
#include <algorithm>
#include <numeric>

#include "ngs/problem/problem.h"
#include "support/quiet.h"
#include "support/splat_reference.h"

namespace ngs::test {

struct MethodCase {
  std::vector<SplatCase> view;  // the same Gaussians with different cameras
  GaussianCloud cloud;
  Scene scene;
  std::vector<ViewMasks> masks;
  std::vector<ImageF> photos;

  Problem input() const {
    std::vector<std::size_t> views(scene.views.size());
    std::iota(views.begin(), views.end(), std::size_t(0));
    return {cloud, scene, views, [this](std::size_t v) { return masks[v]; },
            [this](std::size_t v) { return photos[v]; }};
  }
};

/// Object k's mask is a disc that shifts slightly from view to view; a corner of every view is unknown.
inline ViewMasks disc_masks(const Camera& camera, int objects, double shift) {
  ViewMasks m{.width_px = camera.width_px, .height_px = camera.height_px, .target = {}, .known = {}, .available = true};
  m.target.resize(std::size_t(objects));
  for (int y = 0; y < camera.height_px; ++y)
    for (int x = 0; x < camera.width_px; ++x) {
      for (int k = 0; k < objects; ++k) {
        const double cx = camera.width_px * (0.35 + 0.3 * k) + shift, cy = camera.height_px * 0.5;
        m.target[std::size_t(k)].push_back(std::hypot(x - cx, y - cy) < 0.24 * camera.width_px ? 1.f : 0.f);
      }
      m.known.push_back(x + y > camera.height_px / 5);
    }
  return m;
}

inline MethodCase method_case(std::uint64_t seed, int gaussians, int views, int objects = 1) {
  MethodCase c;
  const SplatCase base = splat_case(seed, gaussians, 56, 40);
  c.cloud = float_cloud(base);
  for (int k = 0; k < objects; ++k) c.scene.objects.push_back({"object" + std::to_string(k), std::uint32_t(k + 1)});
  for (int v = 0; v < views; ++v) {
    SplatCase moved = base;
    moved.camera.name = "view" + std::to_string(v) + ".png";
    moved.camera.cx += 1.5 * v;
    moved.camera.fy *= 1 - 0.03 * v;
    moved.camera.translation.x += 0.05 * v;
    c.scene.views.push_back({moved.camera, "", "", Split::kTrain});
    c.masks.push_back(disc_masks(moved.camera, objects, 1.0 * v));
    c.photos.push_back(render({}, c.cloud, moved.camera, {}, {}).colour);
    for (std::size_t i = 0; i < c.photos.back().data.size(); ++i)
      c.photos.back().data[i] = float(
          std::clamp(double(c.photos.back().data[i]) + 0.1 * rng_normal(seed + 1, RngStream::kTest, i), 0.0, 1.0));
    c.view.push_back(std::move(moved));
  }
  return c;
}

/// Row i of the result is row order[i] of the input.
inline GaussianCloud permuted(const GaussianCloud& cloud, const std::vector<std::size_t>& order) {
  GaussianCloud out = cloud;
  const auto gather = [&](auto& to, const auto& from) {
    const std::size_t columns = from.size() / order.size();
    for (std::size_t i = 0; i < order.size(); ++i)
      for (std::size_t c = 0; c < columns; ++c) to[i * columns + c] = from[order[i] * columns + c];
  };
  gather(out.position, cloud.position);
  gather(out.rotation, cloud.rotation);
  gather(out.log_scale, cloud.log_scale);
  gather(out.logit_opacity, cloud.logit_opacity);
  gather(out.sh_dc, cloud.sh_dc);
  gather(out.sh_rest, cloud.sh_rest);
  gather(out.usable, cloud.usable);
  return out;
}

/// Reference values over the case's views, [N] each.
struct ReferenceWeights {
  std::vector<double> weight, object_weight;  // W, and W1 of object 0
  std::vector<double> spread;                 // of W: the sum of the rounding errors of its terms
  bool clear = true;  // false: a contribution is at a threshold, where float may be on the other side
};
inline ReferenceWeights reference_weights(const MethodCase& c) {
  ReferenceWeights r;
  r.weight.assign(std::size_t(c.cloud.size()), 0);
  r.object_weight = r.spread = r.weight;
  for (std::size_t v = 0; v < c.view.size(); ++v) {
    const auto image = reference_render(c.view[v], {});
    for (std::size_t p = 0; p < image.size(); ++p) {
      r.clear &= image[p].closest_threshold > 1e-5;
      if (!c.masks[v].known[p]) continue;
      for (std::size_t k = 0; k < image[p].weight.size(); ++k) {
        const auto& [g, w] = image[p].weight[k];
        r.weight[std::size_t(g)] += w;
        r.spread[std::size_t(g)] += w * image[p].condition[k];
        r.object_weight[std::size_t(g)] += w * double(c.masks[v].target[0][p]);
      }
    }
  }
  return r;
}

}  // namespace ngs::test
