#pragma once
// Random models, with or without invalid values, and the views in which projection and binning are tested.
#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include "ngs/ops/splat/binned_view.h"
#include "ngs/ops/splat/cloud_view.h"

namespace ngs::test {

inline constexpr float kInf = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();

/// Centred at the origin, most within 3 of it; sizes from specks to larger than the scene.
inline GaussianCloud random_cloud(std::int64_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  GaussianCloud cloud;
  cloud.resize(n, 1);
  for (float& x : cloud.position) x = 1.5f * normal(random);
  for (float& x : cloud.rotation) x = normal(random);
  for (float& x : cloud.log_scale) x = -3.f + 1.5f * normal(random);
  for (float& x : cloud.logit_opacity) x = 3.f * normal(random);
  for (float& x : cloud.sh_dc) x = normal(random);
  for (float& x : cloud.sh_rest) x = 0.2f * normal(random);
  return cloud;
}

/// Sets extreme or non-finite values in every tenth row, without clearing `usable`.
inline void make_hostile(GaussianCloud& cloud) {
  const float hostile[] = {kNan, kInf, -kInf, 0.f, 1e30f, -1e30f, 1e-40f, 39.f, -120.f};
  const std::size_t kinds = std::size(hostile);
  for (std::size_t i = 0; i < std::size_t(cloud.size()); i += 10) {
    const float value = hostile[i / 10 % kinds];
    switch (i / 10 / kinds % 6) {
      case 0: cloud.position[3 * i + i % 3] = value; break;
      case 1: cloud.rotation[4 * i + i % 4] = value; break;
      case 2: cloud.log_scale[3 * i + i % 3] = value; break;
      case 3: cloud.logit_opacity[i] = value; break;
      case 4: std::fill_n(&cloud.log_scale[3 * i], 3, value); break;
      default: std::fill_n(&cloud.rotation[4 * i], 4, value);
    }
  }
}

inline Camera camera_at(double z) {
  return {"", 150, 90, 120, 118, 70.5, 46.25, {{1, 0, 0, 0, 0.8, -0.6, 0, 0.6, 0.8}}, {0.1, -0.2, z}};
}

struct RandomView {
  GaussianCloud cloud;
  Camera camera;
  SplatOptions options;
  std::vector<std::uint8_t> include;  // empty: all
  const std::uint8_t* included() const { return include.empty() ? nullptr : include.data(); }
  CloudView<float> view() const { return cloud_view(cloud, 1, included()); }
};

/// Calls f(scene) for clouds with cameras in front of and inside them, both families, filters and include lists.
template <class F>
void for_each_scene(const F& f) {
  for (const bool hostile : {false, true})
    for (const double z : {6.0, 0.5})
      for (const Compat compat : {Compat::kInria, Compat::kGsplat})
        for (const bool antialiased : {false, true})
          for (const std::size_t every : {0, 2, 40}) {
            INFO("hostile ", hostile, ", z ", z, ", compat ", int(compat), ", antialiased ", antialiased, ", one of ",
                 every);
            RandomView scene{random_cloud(3000, 7), camera_at(z), {.compat = compat, .antialiased = antialiased}, {}};
            if (hostile) make_hostile(scene.cloud);
            for (std::size_t i = 0; every > 0 && i < 3000; ++i) scene.include.push_back(i % every == 0);
            for (std::size_t i = 0; i < 100; ++i) scene.cloud.usable[7 * i] = 0;
            f(scene);
          }
}

/// Indices of the rows of a view that touch a tile, sorted by Gaussian index.
inline std::vector<std::size_t> by_index(const ProjectedView<float>& view) {
  std::vector<std::size_t> order;
  for (std::size_t at = 0; at < view.id.size(); ++at)
    if (view.rect[at].x_begin != view.rect[at].x_end) order.push_back(at);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return view.id[a] < view.id[b]; });
  return order;
}

}  // namespace ngs::test
