// Projection of one Gaussian: footprint, conic, opacity and culling.
#include <doctest/doctest.h>

#include <cmath>

#include "ngs/ops/splat/cloud_view.h"
#include "ngs/ops/splat/splat_view.h"
#include "support/projected_view.h"
#include "support/projection_reference.h"
#include "support/stability.h"

namespace ngs {
namespace {

using namespace test::projection;
using test::Random;
using test::Worst;

float det_by_difference(const ProjectedGaussian<float>& p) {
  const float b = -p.conic_b * p.det;
  return p.cov_xx * p.cov_yy - b * b;
}
float raw_det_by_difference(const ProjectionContext<float>& c) {
  return dot(c.v0, c.v0) * dot(c.v1, c.v1) - dot(c.v0, c.v1) * dot(c.v0, c.v1);
}

/// The conic relative to its own size.
void conic_ratios(const Projected& got, const Truth& want, Worst& worst) {
  const Real condition = want.condition, cross = std::sqrt(want.a * want.c) / want.det;
  worst.ours(got.out.conic_a, want.c / want.det, condition);
  worst.ours(got.out.conic_c, want.a / want.det, condition);
  worst.ours_ratio(std::abs(double(Real(got.out.conic_b) + want.b / want.det)) /
                   double(0x1p-23 * cross * want.cross_condition));
}
void naive_conic_by_difference(const Projected& got, const Truth& want, Worst& worst) {
  worst.naive(got.out.cov_yy / det_by_difference(got.out), want.c / want.det, want.condition);
}

/// Projects a cloud of one Gaussian.
struct One {
  GaussianCloud cloud;
  explicit One(const Probe& p) {
    cloud.resize(1, 0);
    cloud.position = {p.t.x, p.t.y, p.t.z};
    std::copy_n(p.rotation, 4, cloud.rotation.begin());
    std::copy_n(p.log_scale, 3, cloud.log_scale.begin());
    cloud.logit_opacity[0] = 3;
  }
  ProjectedView<float> view_of(const Camera& camera) const {
    return project_view({}, cloud_view(cloud, 0, nullptr), relative_camera(camera, cloud), {});
  }
  ProjectedView<float> view() const { return view_of(front_camera()); }
};

}  // namespace

HARD_CASE("projection: a needle keeps the determinant of its footprint", "scale ratio", {1, 1e2, 1e4, 1e6}, 2.3,
          {"a c - b²", 2e4}) {
  const Probe p(random, 1, 1 / h, 1 / h);
  const Projected got(p);
  const Truth want(p, got.camera);
  worst.ours(got.out.det, want.det, want.condition);
  worst.naive(det_by_difference(got.out), want.det, want.condition);
}

HARD_CASE("projection: a needle keeps the determinant of the unblurred covariance", "scale ratio", {1, 1e2, 1e4, 1e6},
          3.3, {"a c - b²", 1e10}) {
  const Probe p(random, 1, 1 / h, 1 / h);
  const Projected got(p);
  const Truth want(p, got.camera);
  worst.ours(got.context.det_raw, want.det_raw, want.raw_condition);
  worst.naive(raw_det_by_difference(got.context), want.det_raw, want.raw_condition);
}

HARD_CASE("projection: a disc seen edge-on keeps its conic", "scale ratio", {1, 1e2, 1e4, 1e6}, 1.9,
          {"divided by a c - b²", 20}) {
  const Probe p(random, 3, 3, 3 / h);
  const Projected got(p);
  const Truth want(p, got.camera);
  conic_ratios(got, want, worst);
  naive_conic_by_difference(got, want, worst);
}

HARD_CASE("projection: a Gaussian of any size keeps its conic", "scale, world", {1e-9, 1e-3, 1, 1e2, 1e4}, 2.3,
          {"divided by a c - b²", 90}) {
  const Probe p(random, h, 0.1 * h, 0.01 * h);
  const Projected got(p);
  const Truth want(p, got.camera);
  conic_ratios(got, want, worst);
  naive_conic_by_difference(got, want, worst);
}

HARD_CASE("projection: a Gaussian without extent has the footprint of the low-pass filter", "log scale",
          {9, -20, -60, -200, -1e30, -INFINITY}, 0.23, {"the inverse of the unblurred covariance", test::kWrong}) {
  Probe p(random, 1, 1, 1);
  for (float& s : p.log_scale) s = float(h);
  const Projected got(p);
  const float naive = dot(got.context.v1, got.context.v1) / got.context.det_raw;
  if (h > 0) {  // the filter is negligible for a large Gaussian
    const Truth want(p, got.camera);
    worst.naive(naive, want.c / want.det, want.condition);
    return;
  }
  worst.ours(got.out.conic_a, 1 / Real(0.3f));
  worst.ours(got.out.conic_c, 1 / Real(0.3f));
  worst.ours_is(std::abs(got.out.conic_b) <= 1e-9f && std::isfinite(got.context.det_raw));
  worst.naive(naive, 1 / Real(0.3f));
}

HARD_CASE("projection: a Gaussian whose covariance overflows float is culled", "log scale",
          {30, 41, 80, 1e30, INFINITY}, 0, {"conic of an infinite covariance", test::kWrong}) {
  Probe p(random, 1, 1, 1);
  for (float& s : p.log_scale) s = float(h);
  const One one(p);
  const auto view = one.view();
  worst.ours_is(view.id.empty() || (std::isfinite(view.record[0].form.a()) && view.record[0].form.a() >= 0));
  GaussianCloud cloud = one.cloud;
  classify(cloud);
  worst.ours_is(cloud.usable[0] == (h <= 40));
  worst.naive_is(std::isfinite(Projected(p).out.conic_a));
}

HARD_CASE("projection: Gaussians on or behind the near plane are culled", "camera z, world",
          {0.2000001, 0.2, 1e-20, 0, -1e-20, -5}, 0, {"x / z without a near plane", test::kWrong}) {
  Probe p(random, 0.01, 0.01, 0.01);
  p.t = {0.1f * float(h) * p.t.x, 0.1f * float(h) * p.t.y, float(h)};
  const auto view = One(p).view();
  worst.ours_is(view.id.size() == (float(h) > 0.2f ? 1 : 0));
  const Projected naive(p);
  const bool drawn = std::isfinite(naive.out.conic_a) && naive.out.conic_a > 0 && std::isfinite(naive.out.mean_x);
  worst.naive_is(drawn == (float(h) > 0.2f));
}

HARD_CASE("projection: far off-screen the Jacobian is clamped to the edge of the view", "offset, px",
          {0, 1e3, 1e4, 1e6}, 1.2, {"Jacobian at the unclamped slope", 3e5}) {
  Probe p(random, 0.3, 0.2, 0.1);
  p.t.x = float(h / kFocal * double(p.t.z));
  const Projected got(p);
  const Truth want(p, got.camera);
  conic_ratios(got, want, worst);
  ProjectionCamera<float> unclamped = got.camera;
  unclamped.x_lo = unclamped.y_lo = -INFINITY;
  unclamped.x_hi = unclamped.y_hi = INFINITY;
  worst.naive(Projected(p, false, unclamped).out.conic_a, want.c / want.det, want.condition);
}

HARD_CASE("projection: a Gaussian at the camera's centre has a colour and no footprint", "distance, world",
          {1, 1e-10, 1e-20, 0}, 0, {"d / |d|", test::kWrong}) {
  Probe p(random, 0.1, 0.1, 0.1);
  const Vec3<float> d{float(0.1 * h * random.uniform(-1, 1)), 0, float(h * random.uniform(0.5, 1))};
  const auto dc = random.uniform_vector<float>(3, -1, 1), rest = random.uniform_vector<float>(45, -0.1, 0.1);
  const Vec3<float> rgb = sh_colour(3, d, dc.data(), rest.data());
  worst.ours_is(std::isfinite(rgb.x) && std::isfinite(rgb.y) && std::isfinite(rgb.z));
  p.t = d;
  worst.ours_is(One(p).view().id.empty() == !(d.z > 0.2f));
  worst.naive_is(std::isfinite(d.x / std::sqrt(dot(d, d))));
}

HARD_CASE("projection: opacity keeps its accuracy at saturated logits", "|logit|", {1, 20, 80, 100}, 1.7,
          {"e^x / (1 + e^x)", test::kWrong}) {
  Probe p(random, 0.1, 0.1, 0.1);
  p.logit = float((random.uniform(0, 1) < 0.5 ? -1 : 1) * h * random.uniform(0.9, 1));
  if (p.logit < -86) return;  // below the normal numbers of float
  const Real want = 1 / (1 + std::exp(-Real(p.logit)));
  worst.ours(Projected(p).out.opacity, want);
  worst.naive(std::exp(p.logit) / (1 + std::exp(p.logit)), want);
}

HARD_CASE("projection: a saturated opacity still has its gradient", "logit", {0, 5, 10, 20, 80}, 2.2, {"1 - s", 4e6}) {
  Probe p(random, 0.1, 0.1, 0.1);
  p.logit = float(h * random.uniform(0.9, 1));
  Projected got(p);
  const auto g = project_gaussian_backward(got.camera, p.t, got.out, got.context, {0, 0, 0, 0, 0, 1});
  const Real e = std::exp(-Real(p.logit)), want = e / (1 + e);
  worst.ours(g.logit_opacity, want);
  worst.naive(1 - sigmoid(p.logit), want);
}

HARD_CASE("projection: a quaternion of any length is the rotation of its direction", "log10 of the length",
          {0, 5, 18, 22, 37}, 2.8, {"q / sqrt(q·q)", test::kWrong}) {
  const double length = std::pow(10.0, (random.uniform(0, 1) < 0.5 ? -1 : 1) * h);
  Vec4<float> q{float(length * random.uniform(0.2, 1)), float(length * random.uniform(-1, 1)),
                float(length * random.uniform(-1, 1)), float(length * random.uniform(-1, 1))};
  Real norm = 0;
  for (const float x : {q.x, q.y, q.z, q.w}) norm += Real(x) * x;
  float inv;
  const Vec4<float> u = normalised(q, inv);
  worst.ours(u.x, q.x / std::sqrt(norm));
  worst.ours(u.w, q.w / std::sqrt(norm));
  const float root = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  worst.naive(q.x / root, q.x / std::sqrt(norm));
}

HARD_CASE("projection: the zero quaternion is the identity and has no gradient", "real part, the others 0",
          {1, 1e-10, 0}, 0, {"q / sqrt(q·q)", test::kWrong}) {
  Probe p(random, 0.3, 0.2, 0.1);
  std::fill_n(p.rotation, 4, 0.f);
  p.rotation[0] = float(h);
  Projected got(p);
  const auto g = project_gaussian_backward(got.camera, p.t, got.out, got.context, {1, 1, 1, 1, 1, 1});
  p.rotation[0] = 1;
  const Projected identity(p);
  worst.ours_is(got.out.conic_a == identity.out.conic_a && got.out.conic_b == identity.out.conic_b);
  worst.ours_is(h > 0 || (g.rotation.x == 0 && g.rotation.y == 0 && g.rotation.z == 0 && g.rotation.w == 0));
  worst.naive_is(float(h) / std::sqrt(float(h) * float(h)) == identity.context.unit_rotation.x);
}

HARD_CASE("projection: a scene far from its origin keeps its details", "offset, world", {0, 1e2, 1e4, 1e6}, 0.86,
          {"R p + t in float", 1e5}) {
  Probe p(random, 0.01, 0.01, 0.01);
  One one(p);
  Camera camera = front_camera();
  const Vec3<double> origin{h, -0.7 * h, 0.3 * h};
  one.cloud.origin = {origin.x, origin.y, origin.z};
  camera.translation = -1.0 * origin;
  const auto view = project_view({}, cloud_view(one.cloud, 0, nullptr), relative_camera(camera, one.cloud), {});
  const Real want = Real(camera.fx) * p.t.x / p.t.z + camera.cx;
  worst.ours(float(view.record.at(0).mean_x), want);
  worst.ours_ratio(std::abs(double(view.record[0].mean_x - want)) / 1e-6);  // px
  const float world_x = float(origin.x) + p.t.x, world_z = float(origin.z) + p.t.z;
  const float x = world_x + float(camera.translation.x), z = world_z + float(camera.translation.z);
  worst.naive(float(camera.fx) * x / z + float(camera.cx), want);
}

HARD_CASE("projection: the offset to the camera is accurate for positions far from the origin",
          "distance from the origin, world", {1, 1e2, 1e4, 1e6}, 1, {"p - centre in float", 2e4}) {
  Probe p(random, 0.01, 0.01, 0.01);
  Camera camera = front_camera();
  const Vec3<double> centre{h * random.uniform(0.5, 1), h * random.uniform(0.5, 1), h * random.uniform(0.5, 1)};
  camera.translation = -1.0 * centre;
  const Vec3<double> world = centre + Vec3<double>{p.t.x, p.t.y, 2 * double(p.t.z)};
  p.t = {float(world.x), float(world.y), float(world.z)};  // the input: its rounding does not count
  const auto view = One(p).view_of(camera);
  const Real x = Real(p.t.x) - centre.x, z = Real(p.t.z) - centre.z;
  const Real want = camera.fx * x / z + camera.cx;
  if (want < 0 || want > kWidth) return;
  worst.ours_ratio(double(std::abs(view.record.at(0).mean_x - want)) / (kWidth * 0x1p-23));
  const float naive_x = p.t.x - float(centre.x), naive_z = p.t.z - float(centre.z);
  const float naive = float(camera.fx) * naive_x / naive_z + float(camera.cx);
  worst.naive_ratio(double(std::abs(naive - want)) / (kWidth * 0x1p-23));
}

HARD_CASE("projection: the antialiasing compensation keeps its accuracy down to its floor", "footprint, px",
          {10, 1, 0.1, 0.045, 0.01}, 1, {"sqrt(max(a c - b², 0) / det)", 80}) {
  const double z = 4, s = h * z / kFocal;
  Probe p(random, s, s * 1e-3, s * 10);
  p.logit = 90;  // exactly opaque: the opacity is the compensation
  const Projected got(p, true);
  const Truth want(p, got.camera);
  const Real factor = std::sqrt(std::max(want.det_raw / want.det, Real(float(kCompensationFloor2))));
  worst.ours(got.out.opacity, factor, 2 + want.raw_condition);
  const float raw = raw_det_by_difference(got.context);
  worst.naive(std::sqrt(std::max(raw / got.out.det, float(kCompensationFloor2))), factor, 2 + want.raw_condition);
}

HARD_CASE("projection: gradients of needles stay as accurate as their conic", "scale ratio", {1, 1e2, 1e4}, 15,
          "not applicable: the reference is the same kernel in double, whose adjoint tests/grad proves") {
  const Probe p(random, 0.1, 0.1 / h, 0.1 / h);
  const Projected got(p);
  const Truth want(p, got.camera);
  const auto cam = projection_camera<double>(front_camera(), {});
  double rotation[4], log_scale[3];
  std::copy_n(p.rotation, 4, rotation);
  std::copy_n(p.log_scale, 3, log_scale);
  const Vec3<double> t{p.t.x, p.t.y, p.t.z};
  ProjectionContext<double> ctx;
  const auto out = project_gaussian(cam, t, {rotation, log_scale, 0.0}, ctx);
  float u[6];
  for (float& x : u) x = float(random.uniform(-1, 1));
  const auto g = project_gaussian_backward(got.camera, p.t, got.out, got.context, {u[0], u[1], u[2], u[3], u[4], u[5]});
  const auto w = project_gaussian_backward(cam, t, out, ctx, {u[0], u[1], u[2], u[3], u[4], u[5]});
  // The intermediate terms, |Q|² |V|², may cancel.
  const double conic = out.conic_a + out.conic_c, terms = conic * conic * (out.cov_xx + out.cov_yy);
  const auto size = [](Vec3<double> v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); };
  const auto error = [&](Vec3<float> a, Vec3<double> b) { return size(Vec3<double>{a.x, a.y, a.z} - b) * 0x1p23; };
  worst.ours_ratio(error(g.log_scale, w.log_scale) / (size(w.log_scale) + terms));
  worst.ours_ratio(error(g.t, w.t) / (size(w.t) + (kFocal + terms) / t.z));
}

}  // namespace ngs
