#include "ngs/cut/contours/straddler_split.h"

#include <doctest/doctest.h>

#include <cmath>

#include "ngs/math/quat.h"
#include "ngs/ops/splat/evidence.h"
#include "support/joint_case.h"

namespace ngs {
namespace {

TEST_CASE("two halves keep the centre, the covariance and the optical depth of their parent") {
  GaussianCloud cloud;
  cloud.resize(2, 0);
  const float rotation[4] = {0.6f, -0.3f, 0.7f, 0.2f}, log_scale[3] = {-1.f, 0.4f, -3.f}, position[3] = {1, -2, 3};
  for (std::size_t i = 0; i < 2; ++i) {
    std::copy_n(rotation, 4, &cloud.rotation[i * 4]);
    std::copy_n(log_scale, 3, &cloud.log_scale[i * 3]);
    std::copy_n(position, 3, &cloud.position[i * 3]);
    cloud.logit_opacity[i] = 1.2f;
  }
  edit_rows({}, {{0, RowOrigin::kKept}, {1, RowOrigin::kHalf0}, {1, RowOrigin::kHalf1}}, 0, cloud);
  REQUIRE(cloud.size() == 3);
  const float *a = &cloud.position[3], *b = &cloud.position[6];
  double shift2 = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK((a[k] + b[k]) / 2 == doctest::Approx(position[k]).epsilon(1e-6));
    shift2 += double(a[k] - b[k]) * double(a[k] - b[k]) / 4;
  }
  // Along the longest axis the joint variance is shift² + the halves' own; the other axes do not change.
  const double own = std::exp(2 * double(cloud.log_scale[4]));
  CHECK(shift2 + own == doctest::Approx(std::exp(2 * 0.4)).epsilon(1e-5));
  CHECK(cloud.log_scale[3] == log_scale[0]);
  CHECK(cloud.log_scale[5] == log_scale[2]);
  // ∫ -log(1 - opacity) along that axis ∝ depth · length.
  const auto depth = [&](std::size_t i) { return std::log1p(std::exp(double(cloud.logit_opacity[i]))); };
  CHECK(2 * depth(1) * std::sqrt(own) == doctest::Approx(depth(0) * std::exp(0.4)).epsilon(1e-5));
}

TEST_CASE("halves of invisible and of opaque Gaussians stay finite") {
  GaussianCloud cloud;
  cloud.resize(3, 0);
  for (std::size_t i = 0; i < 3; ++i) cloud.rotation[i * 4] = 1;
  cloud.logit_opacity = {-800.f, 90.f, 0.f};
  std::vector<CloudRow> rows;
  for (std::int64_t i = 0; i < 3; ++i) {
    rows.push_back({i, RowOrigin::kHalf0});
    rows.push_back({i, RowOrigin::kHalf1});
  }
  edit_rows({}, rows, 0, cloud);
  for (const float x : cloud.logit_opacity) CHECK(std::isfinite(x));
}

TEST_CASE("only Gaussians that a contour crosses count as straddling") {
  const auto c = test::joint_case();
  Problem input = c->input();
  const Straddling across = straddling({}, input, c->truth);
  const std::vector<double>& px = across.px;
  Evidence expected(c->truth.size(), 1);
  for (const std::size_t v : input.views)
    add_view_evidence({}, c->truth, {c->scene.views[v].camera, c->masks[v]}, input.splat, expected);
  for (std::size_t i = 0; i < px.size(); ++i) CHECK(across.weight.value(i) == expected.weight.value(i));
  std::vector<std::uint8_t> last(px.size());
  std::fill(last.end() - 50, last.end(), 1);
  const RowNumbers of(last);
  const Straddling some = straddling({}, input, c->truth, &of);
  REQUIRE(some.evidence.gaussians == 50);
  const std::size_t first = px.size() - 50;
  for (std::size_t i = 0; i < 50; ++i) {
    CHECK(some.px[i] == px[first + i]);
    CHECK(some.weight.value(i) == across.weight.value(first + i));
    CHECK(some.evidence.views[i] == expected.views[first + i]);
    CHECK(some.evidence.object_weight(i, 0) == expected.object_weight(first + i, 0));
  }
  double inside = 0, worst_wall = 0, most = 0;
  for (std::size_t i = 0; i < px.size(); ++i) {
    most = std::max(most, px[i]);
    if (c->is_ball[i] > 0) inside += px[i];
    // The wall far from the ball's silhouette: no contour is near.
    else if (std::hypot(c->truth.position[i * 3], c->truth.position[i * 3 + 1]) > 2)
      worst_wall = std::max(worst_wall, px[i]);
  }
  CHECK(inside > 0);
  CHECK(worst_wall < 0.05 * most);
  // Masks that cover the whole image have no contour.
  input.load_masks = [&](std::size_t v) {
    ViewMasks all = c->masks[v];
    for (float& x : all.target[0]) x = 1;
    return all;
  };
  for (const double x : straddling({}, input, c->truth).px) CHECK(x <= 1e-12 * most);
}

TEST_CASE("a split takes the Gaussians above the bound, keeps the order of rows and appends the halves in pairs") {
  const std::vector<double> px = {0, 5, 2, 9, 1};
  const auto rows = split_straddlers(px, 4);
  REQUIRE(rows.size() == 7);
  const std::int64_t source[7] = {0, 2, 4, 1, 1, 3, 3};
  for (std::size_t r = 0; r < 7; ++r) {
    CHECK(rows[r].source == source[r]);
    CHECK((rows[r].origin == RowOrigin::kKept) == (r < 3));
  }
  CHECK(split_straddlers({}, 1).empty());
  CHECK(split_straddlers(px, 100).size() == 5);
}

}  // namespace
}  // namespace ngs
