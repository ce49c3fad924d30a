#pragma once
// Splats of a block on a floor, with and without a wall: the background has a hole where the block hides it.
#include <cmath>
#include <functional>

#include "ngs/math/vectors.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs::test {

struct HoleModel {
  using Vec = orbit::Vec;

  GaussianCloud cloud;
  std::vector<std::uint8_t> object;
  double spacing = 0.05;

  /// A Gaussian that is flat along `axis` (0..2); -1: a ball. `grey` is its sh_dc in all channels.
  void add(Vec p, int axis, double grey, bool is_object) {
    const std::size_t i = object.size();
    cloud.resize(std::int64_t(i) + 1, 0);
    const double at[3] = {p.x, p.y, p.z};
    for (std::size_t a = 0; a < 3; ++a) {
      cloud.position[3 * i + a] = float(at[a]);
      cloud.sh_dc[3 * i + a] = float(grey);
      cloud.log_scale[3 * i + a] = float(std::log((int(a) == axis ? 0.1 : 0.7) * spacing));
    }
    cloud.rotation[4 * i] = 1;
    cloud.logit_opacity[i] = 4;
    cloud.usable[i] = 1;
    object.push_back(is_object);
  }

  /// A floor over [-1, 1]² at the given heights, without the Gaussians for which is_hole(x, y).
  void add_floor(const std::function<double(double, double)>& height, const std::function<double(double, double)>& grey,
                 const std::function<bool(double, double)>& is_hole) {
    const int n = int(std::lround(1 / spacing));
    for (int j = -n; j <= n; ++j)
      for (int i = -n; i <= n; ++i) {
        const double x = spacing * i, y = spacing * j;
        if (!is_hole(x, y)) add({x, y, height(x, y)}, 2, grey(x, y), false);
      }
  }

  /// The surface of a block, as balls of the object; grey 1.
  void add_block(Vec low, Vec high) {
    const auto steps = [&](double a, double b) { return std::max(1, int(std::lround((b - a) / spacing))); };
    const int nx = steps(low.x, high.x), ny = steps(low.y, high.y), nz = steps(low.z, high.z);
    for (int k = 0; k <= nz; ++k)
      for (int j = 0; j <= ny; ++j)
        for (int i = 0; i <= nx; ++i)
          if (i == 0 || j == 0 || k == 0 || i == nx || j == ny || k == nz)
            add({low.x + (high.x - low.x) * i / nx, low.y + (high.y - low.y) * j / ny,
                 low.z + (high.z - low.z) * k / nz},
                -1, 1, true);
  }

  /// A block of 0.6 x 0.6 x 0.6 on a flat grey floor with a hole below it.
  static HoleModel on_floor() {
    HoleModel model;
    const auto under = [](double x, double y) { return std::max(std::abs(x), std::abs(y)) < 0.28; };
    model.add_floor([](double, double) { return 0.0; }, [](double, double) { return 0.0; }, under);
    model.add_block({-0.3, -0.3, 0.03}, {0.3, 0.3, 0.6});
    return model;
  }

  /// The block in the corner of the floor z = 0 and the wall y = -0.3, which both have a hole behind it. The wall has
  /// grey -1.
  static HoleModel in_corner() {
    HoleModel model;
    const auto under = [](double x, double y) { return y < -0.3 || (std::abs(x) < 0.28 && y < 0.28); };
    model.add_floor([](double, double) { return 0.0; }, [](double, double) { return 0.0; }, under);
    for (int k = 0; k <= 24; ++k)
      for (int i = -20; i <= 20; ++i) {
        const double x = model.spacing * i, z = model.spacing * k;
        if (!(std::abs(x) < 0.28 && z < 0.58)) model.add({x, -0.3, z}, 1, -1, false);
      }
    model.add_block({-0.3, -0.27, 0.03}, {0.3, 0.3, 0.6});
    return model;
  }
};

}  // namespace ngs::test
