#include "occupancy/occupancy_loss.h"

#include <doctest/doctest.h>

#include <cmath>

namespace ngs::bench {
namespace {

/// Points 0.01 apart on the square [0, 1]² of the plane z = 0.
std::vector<float> sheet() {
  std::vector<float> points;
  for (int y = 0; y <= 100; ++y)
    for (int x = 0; x <= 100; ++x)
      for (const float value : {0.01f * float(x), 0.01f * float(y), 0.f}) points.push_back(value);
  return points;
}

GaussianCloud one_disc(float z) {
  GaussianCloud cloud;
  cloud.resize(1, 0);
  cloud.position = {0.5f, 0.5f, z}, cloud.rotation = {1, 0, 0, 0};
  cloud.log_scale = {std::log(0.02f), std::log(0.02f), std::log(0.001f)};
  cloud.logit_opacity = {0}, cloud.usable = {1};
  return cloud;
}

CloudGradients no_gradient() {
  CloudGradients out;
  out.resize(1, 0, 0);
  return out;
}

}  // namespace

TEST_CASE("a voxel has the side that holds k points at the density of the k-th neighbour") {
  const Voxels voxels(sheet(), 50, 0);
  // π r² 10⁴ = 50 points: r = 0.04; s = cbrt(4/3 π) r
  CHECK(voxels.side() == doctest::Approx(1.612 * 0.04).epsilon(0.1));
  const float on[3] = {0.5f, 0.5f, 0.f}, far[3] = {0.5f, 0.5f, 0.3f};
  CHECK(voxels.supports(on));
  CHECK(!voxels.supports(far));
  CHECK(!Voxels({}, 50, 0).supports(on));
}

TEST_CASE("L_occ of a supported Gaussian is 0; of an unsupported one its gradient makes it smaller and fainter") {
  const Voxels voxels[2] = {Voxels({}, 20, 0), Voxels(sheet(), 20, 0)};
  CloudGradients gradients = no_gradient();
  const std::vector<std::uint8_t> object = {1};
  const GaussianCloud on = one_disc(0), off = one_disc(0.5f);
  CHECK(add_occupancy_gradient({on, object, voxels}, {}, 1, gradients) == 0);
  CHECK(gradients.logit_opacity[0] == 0);
  const double loss = add_occupancy_gradient({off, object, voxels}, {.per_gaussian = 2000}, 1, gradients);
  CHECK(loss == doctest::Approx(0.5 * 2 * 3.14159 / 36).epsilon(0.05));  // α times the mean of G over ±3
  CHECK(gradients.logit_opacity[0] == doctest::Approx(loss / 2).epsilon(1e-5));
  CHECK(gradients.log_scale[0] > 0);
  CHECK(gradients.log_scale[1] > 0);
  CHECK(gradients.log_scale[2] == 0);
}

TEST_CASE("L_bound is the weight of the other class, with gradients of label and alpha") {
  RenderedView view;
  view.width_px = 2, view.height_px = 1;
  view.label = ImageF(2, 1, 1), view.alpha = ImageF(2, 1, 1);
  view.label.data = {0.7f, 0.3f}, view.alpha.data = {0.9f, 1.f};
  ViewGradients out;
  CHECK(boundary_gradient(view, {1, 0}, 2, out) == doctest::Approx((0.2 + 0.3) / 2));
  CHECK(out.label.data[0] == -1.f);
  CHECK(out.alpha.data[0] == 1.f);
  CHECK(out.label.data[1] == 1.f);
  CHECK(out.alpha.data[1] == 0.f);
}

}  // namespace ngs::bench
