#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ngs/edit/finish/clip_ellipsoid.h"
#include "ngs/math/quat.h"

namespace ngs::finish {
namespace {

using Vec = Vec3<double>;

constexpr Mat3<double> kUpright{{1, 0, 0, 0, 1, 0, 0, 0, 1}};

Ellipsoid needle() { return {{0, 0, 0}, kUpright, {0.01, 1, 0.01}}; }
Ellipsoid disc() { return {{0, 0, 0}, kUpright, {1, 1, 0.01}}; }

bool same(const Ellipsoid& a, const Ellipsoid& b) {
  return a.centre.x == b.centre.x && a.centre.y == b.centre.y && a.centre.z == b.centre.z && a.sigma[0] == b.sigma[0] &&
         a.sigma[1] == b.sigma[1] && a.sigma[2] == b.sigma[2];
}

/// The ends of the outline along y.
double top(const Ellipsoid& e) { return e.centre.y + kOutline * e.sigma[1]; }
double bottom(const Ellipsoid& e) { return e.centre.y - kOutline * e.sigma[1]; }

constexpr double kMinLength = 0.1;

TEST_CASE("a supported ellipsoid is unchanged, an unsupported one too") {
  Ellipsoid e = disc();
  CHECK(clip_ellipsoid(
            kMinLength, [](Vec) { return true; }, e) == Clip::kWithin);
  CHECK(same(e, disc()));
  CHECK(clip_ellipsoid(
            kMinLength, [](Vec) { return false; }, e) == Clip::kUnsupported);
  CHECK(same(e, disc()));
}

TEST_CASE("a needle half outside is clipped to the half inside") {
  Ellipsoid e = needle();
  REQUIRE(clip_ellipsoid(
              kMinLength, [](Vec p) { return p.y <= 0; }, e) == Clip::kClipped);
  CHECK(top(e) == doctest::Approx(0).epsilon(0.01));
  CHECK(bottom(e) == doctest::Approx(-1.2).epsilon(0.01));
  CHECK(e.sigma[1] == doctest::Approx(0.5).epsilon(0.01));
  CHECK(e.sigma[0] == 0.01);  // the other axes are as before
  CHECK(e.sigma[2] == 0.01);
}

TEST_CASE("a needle whose centre is outside keeps its supported end") {
  Ellipsoid e = needle();
  REQUIRE(clip_ellipsoid(
              kMinLength, [](Vec p) { return p.y >= 0.5; }, e) == Clip::kClipped);
  CHECK(bottom(e) == doctest::Approx(0.5).epsilon(0.01));
  CHECK(top(e) == doctest::Approx(1.2).epsilon(0.01));
}

TEST_CASE("of two supported intervals the one nearest to the centre remains") {
  Ellipsoid e = needle();
  REQUIRE(clip_ellipsoid(
              kMinLength, [](Vec p) { return std::abs(p.y) < 0.3 || p.y > 0.9; }, e) == Clip::kClipped);
  CHECK(top(e) == doctest::Approx(0.3).epsilon(0.02));
  CHECK(bottom(e) == doctest::Approx(-0.3).epsilon(0.02));
}

TEST_CASE("what fades out beyond the outline is neither tested nor clipped") {
  Ellipsoid e = needle();
  CHECK(clip_ellipsoid(
            kMinLength, [](Vec p) { return p.y <= 1.25; }, e) == Clip::kWithin);
  CHECK(same(e, needle()));
  CHECK(clip_ellipsoid(
            kMinLength, [](Vec p) { return p.y <= 1.15; }, e) == Clip::kClipped);
}

TEST_CASE("a disc that a plane crosses diagonally loses the part outside and no axis grows") {
  Ellipsoid e = disc();
  REQUIRE(clip_ellipsoid(
              kMinLength, [](Vec p) { return p.x + p.y <= 0; }, e) == Clip::kClipped);
  CHECK(e.sigma[0] <= 1);
  CHECK(e.sigma[1] <= 1);
  double most = 0;  // of x + y over the outline
  for (int k = 0; k < 64; ++k) {
    const double phi = k * 0.0981747704;
    most =
        std::max(most, e.centre.x + e.centre.y + kOutline * (e.sigma[0] * std::cos(phi) + e.sigma[1] * std::sin(phi)));
  }
  CHECK(most < 0.3);  // 1.7 before
}

TEST_CASE("axes whose ends are near the centre are not tested") {
  Ellipsoid e{{0, 0, 0}, kUpright, {0.04, 0.04, 0.04}};
  CHECK(clip_ellipsoid(
            kMinLength, [](Vec p) { return std::abs(p.y) < 0.001; }, e) == Clip::kWithin);
  CHECK(clip_ellipsoid(
            kMinLength, [](Vec p) { return p.y > 0.001; }, e) == Clip::kUnsupported);
}

TEST_CASE("zero, infinite and undefined lengths end and never grow an axis") {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  for (const double odd : {0.0, inf, nan}) {
    CAPTURE(odd);
    Ellipsoid e{{0, 0, 0}, kUpright, {odd, 1, 0.01}};
    (void)clip_ellipsoid(
        0, [](Vec p) { return p.y <= 0; }, e);
    CHECK(e.sigma[1] <= 1);
    CHECK((e.sigma[0] == odd || std::isnan(odd) || e.sigma[0] < odd));
  }
}

using Vec = Vec3<double>;

Ellipsoid turned() {
  const float q[4] = {0.9f, 0.3f, -0.2f, 0.25f};
  return {{0.1, -0.2, 0.3}, axes_of_quaternion(q), {0.5, 0.2, 0.05}};
}

/// The variance along a unit direction.
double variance(const Ellipsoid& e, Vec direction) {
  double sum = 0;
  for (int a = 0; a < 3; ++a) {
    const double along = e.sigma[a] * dot(direction, Vec{e.axes(0, a), e.axes(1, a), e.axes(2, a)});
    sum += along * along;
  }
  return sum;
}

double low(const HalfSpace& side, const Ellipsoid& e) {
  return dot(side.normal, e.centre) - side.offset - side.outline * std::sqrt(variance(e, side.normal));
}
double high(const HalfSpace& side, const Ellipsoid& e) {
  return dot(side.normal, e.centre) - side.offset + side.outline * std::sqrt(variance(e, side.normal));
}

TEST_CASE("an outline in front of the plane is unchanged, one behind it is unsupported and unchanged") {
  Ellipsoid e = turned();
  CHECK(clip_half_space({{0, 0, 1}, -5}, e) == Clip::kWithin);
  CHECK(clip_half_space({{0, 0, 1}, 5}, e) == Clip::kUnsupported);
  CHECK(e.centre.x == turned().centre.x);
  CHECK(e.sigma[0] == turned().sigma[0]);
}

TEST_CASE("an upright Gaussian half behind the plane keeps the half in front, and its extent in the plane") {
  Ellipsoid e{{0, 0, 0}, kUpright, {0.3, 0.2, 0.1}};
  REQUIRE(clip_half_space({{0, 0, 1}, 0, 2}, e) == Clip::kClipped);
  CHECK(e.centre.z == doctest::Approx(0.1));
  CHECK(e.centre.x == doctest::Approx(0));
  CHECK(variance(e, {0, 0, 1}) == doctest::Approx(0.05 * 0.05));
  CHECK(variance(e, {1, 0, 0}) == doctest::Approx(0.3 * 0.3));
  CHECK(variance(e, {0, 1, 0}) == doctest::Approx(0.2 * 0.2));
}

TEST_CASE("a turned Gaussian ends at the plane, its front end stays, and directions in the plane do not grow") {
  const Vec normal = unit(Vec{0.3, -0.5, 0.8});
  for (const double behind : {0.05, 0.2, 0.3}) {
    CAPTURE(behind);
    Ellipsoid e = turned();
    HalfSpace side{normal, 0, 2};
    side.offset = low(side, e) + behind;
    const double front = high(side, e);
    REQUIRE(clip_half_space(side, e) == Clip::kClipped);
    CHECK(low(side, e) == doctest::Approx(0).epsilon(1e-9).scale(1));
    CHECK(high(side, e) == doctest::Approx(front).epsilon(1e-9));
    for (int k = 0; k < 12; ++k) {
      const Vec a = unit(cross(normal, Vec{1, 0, 0})), b = cross(normal, a);
      const Vec d = std::cos(0.5 * k) * a + std::sin(0.5 * k) * b;
      CHECK(variance(e, d) <= variance(turned(), d) * (1 + 1e-9));
    }
    const auto column = [&](int c) { return Vec{e.axes(0, c), e.axes(1, c), e.axes(2, c)}; };
    CHECK(dot(cross(column(0), column(1)), column(2)) == doctest::Approx(1));  // a rotation
  }
}

TEST_CASE("a needle a million times as long as wide keeps its width") {
  Ellipsoid e = turned();
  e.sigma[0] = 1;
  e.sigma[1] = e.sigma[2] = 1e-6;
  const HalfSpace side{unit(Vec{0.3, -0.5, 0.8}), dot(unit(Vec{0.3, -0.5, 0.8}), e.centre), 2};
  REQUIRE(clip_half_space(side, e) == Clip::kClipped);
  std::sort(e.sigma, e.sigma + 3);
  CHECK(e.sigma[0] == doctest::Approx(1e-6).epsilon(0.01));
  CHECK(e.sigma[1] == doctest::Approx(1e-6).epsilon(0.01));
  CHECK(e.sigma[2] == doctest::Approx(0.5).epsilon(0.01));
}

TEST_CASE("a sliver in front of the plane is unsupported") {
  Ellipsoid e{{0, 0, 0}, kUpright, {0.3, 0.2, 0.1}};
  CHECK(clip_half_space({{0, 0, 1}, 0.2 - 0.4 / 65, 2}, e) == Clip::kUnsupported);
  CHECK(clip_half_space({{0, 0, 1}, 0.2 - 0.4 / 63, 2}, e) == Clip::kClipped);
}

TEST_CASE("flat, undefined and infinite Gaussians have a defined answer") {
  Ellipsoid flat{{0, 0, 0}, kUpright, {0.3, 0.2, 0}};
  CHECK(clip_half_space({{0, 0, 1}, 0, 2}, flat) == Clip::kWithin);  // it touches the plane
  Ellipsoid point{{0, 0, -1}, kUpright, {0, 0, 0}};
  CHECK(clip_half_space({{0, 0, 1}, 0, 2}, point) == Clip::kUnsupported);
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  for (const double odd : {inf, nan}) {
    Ellipsoid e{{0, 0, 0}, kUpright, {odd, 1, 1}};
    CHECK(clip_half_space({{1, 0, 0}, 0}, e) == Clip::kWithin);
    Ellipsoid away{{odd, 0, 0}, kUpright, {1, 1, 1}};
    CHECK(clip_half_space({{1, 0, 0}, 0}, away) == Clip::kWithin);
    CHECK(clip_half_space({{1, 0, 0}, odd}, away) == Clip::kWithin);
  }
}

}  // namespace
}  // namespace ngs::finish
