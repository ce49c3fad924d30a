#include "ngs/edit/finish/clip_ellipsoid.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

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

}  // namespace
}  // namespace ngs::finish
