#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ngs/core/error.h"
#include "ngs/make/fit/fit_density.h"
#include "ngs/make/fit/fit_stage.h"
#include "ngs/make/synth/synth_render.h"
#include "ngs/math/stable.h"
#include "ngs/ops/image/metrics.h"
#include "support/error_code.h"

namespace ngs {
namespace {

struct TinyScene {
  std::vector<FitView> views;
  std::vector<FitPoint> points;
};

// The `tiny` recipe, with views of two sizes and every sixth held out; rendered once.
const TinyScene& tiny() {
  static const TinyScene scene = [] {
    synth::Recipe recipe = synth::named_recipe("tiny");
    recipe.views = 12;
    recipe.mixed_sizes = true;
    const synth::AnalyticScene analytic = synth::build_scene(recipe);
    const std::vector<Camera> rig = synth::build_rig(recipe, analytic);
    std::vector<synth::SynthView> views;
    TinyScene out;
    for (std::size_t i = 0; i < rig.size(); ++i) {
      views.push_back(synth::render_view({.threads = 2}, analytic, rig[i], 4));
      out.views.push_back({rig[i], views[i].colour, i % 6 == 2 ? Split::kHeldOut : Split::kTrain});
    }
    for (const SparsePoint& p : synth::sample_points(rig, views, 400, 1)) {
      const auto value = [](std::uint8_t c) { return float(c) / 255.f; };
      out.points.push_back({{float(p.position.x), float(p.position.y), float(p.position.z)},
                            {value(p.rgb[0]), value(p.rgb[1]), value(p.rgb[2])}});
    }
    return out;
  }();
  return scene;
}

bool same(const GaussianCloud& a, const GaussianCloud& b) {
  return a.position == b.position && a.rotation == b.rotation && a.log_scale == b.log_scale &&
         a.logit_opacity == b.logit_opacity && a.sh_dc == b.sh_dc && a.sh_rest == b.sh_rest;
}

FitState run(const FitOptions& options, int threads, int steps, FitState state) {
  Fitter fitter(options, tiny().views, std::move(state), 5);
  for (int i = 0; i < steps; ++i) fitter.step({.threads = threads});
  return fitter.take();
}

FitState start(const FitOptions& options) { return initial_fit({}, options, tiny().points, tiny().views, 5); }

// Three Gaussians of scale 1 (index 1: 0.001), opaque, gradients 0, each visible once.
FitState three() {
  FitState state;
  state.cloud.resize(3, 1);
  for (std::size_t i = 0; i < 3; ++i) {
    state.cloud.rotation[4 * i] = 1;
    state.cloud.position[3 * i] = float(i);
  }
  std::fill_n(state.cloud.log_scale.begin() + 3, 3, std::log(0.001f));
  state.gradient_sum.assign(3, 0.f);
  state.gradient_views.assign(3, 1.f);
  state.moments[kGroupPosition].m = {1, 1, 1, 2, 2, 2, 3, 3, 3};
  state.moments[kGroupPosition].v = state.moments[kGroupPosition].m;
  return state;
}

// Mean squared error of a photo against its means over 4x4 pixels.
double quarter_size_psnr_db(const ImageF& photo) {
  ImageF reduced = photo;
  for (int y = 0; y < photo.height_px; ++y)
    for (int x = 0; x < photo.width_px; ++x)
      for (int c = 0; c < 3; ++c) {
        float sum = 0;
        for (int k = 0; k < 16; ++k) sum += photo.at(x / 4 * 4 + k % 4, y / 4 * 4 + k / 4, c);
        reduced.at(x, y, c) = sum / 16;
      }
  return psnr_db({}, reduced, photo);
}

}  // namespace

TEST_CASE("Gaussians near the camera of a step lose opacity in it, and others keep their bytes") {
  FitOptions fading{.random_points = 2000};
  FitOptions plain = fading;
  plain.near_loss = 0;
  const FitState first = initial_fit({}, fading, {}, tiny().views, 5);
  const GaussianCloud a = run(fading, 1, 1, first).cloud, b = run(plain, 1, 1, first).cloud;
  std::vector<Vec3<double>> centres;
  for (const FitView& view : tiny().views)
    if (view.split == Split::kTrain) centres.push_back(view.camera.centre());
  const Vec3<double> middle = nearest_to_axes(tiny().views);
  int faded = 0, kept = 0, wrong = 0;
  for (std::size_t i = 0; i < std::size_t(a.size()); ++i) {
    const float* p = &first.cloud.position[3 * i];
    double most = 0;  // over the cameras: which one the step used is not known here
    for (const Vec3<double>& c : centres) {
      const Vec3<double> d = Vec3<double>{double(p[0]), double(p[1]), double(p[2])} - c, to = middle - c;
      most = std::max(most, fading.near_loss * (1 - length(d) / length(to) / fading.near_reach));
    }
    const double lost = double(b.logit_opacity[i]) - double(a.logit_opacity[i]);
    if (lost == 0) ++kept;
    if (lost > 0) ++faded;
    wrong += lost < 0 || lost > most + 0.02;  // the step moves positions by less than this
  }
  CHECK(wrong == 0);
  CHECK(faded > 10);
  CHECK(kept > 1000);
  CHECK(a.position == b.position);
}

TEST_CASE("nothing fades before cameras that look outwards from one place") {
  std::vector<FitView> views = tiny().views;
  for (FitView& view : views) view.camera.translation = {0, 0, 0};
  FitOptions fading, plain;
  fading.random_points = plain.random_points = 300;
  plain.near_loss = 0;
  const FitState first = initial_fit({}, fading, {}, views, 5);
  Fitter a(fading, views, first, 5), b(plain, views, first, 5);
  a.step({});
  b.step({});
  CHECK(same(a.state().cloud, b.state().cloud));
}

TEST_CASE("the schedule of 30000 steps is that of 3DGS, and given numbers override it") {
  const FitSchedule s = resolved_schedule({.steps = 30000});
  CHECK(s.sh_every == 1000);
  CHECK(s.densify_from == 500);
  CHECK(s.densify_until == 15000);
  CHECK(s.densify_every == 100);
  CHECK(resolved_schedule({.steps = 1}).densify_every == 10);
  CHECK(resolved_schedule({.steps = 1}).sh_every == 1);
  CHECK(resolved_schedule({.densify_every = 7}).densify_every == 7);
}

TEST_CASE("initial_fit scales Gaussians by their neighbour distances and colours them like the points") {
  std::vector<FitPoint> grid;
  for (int i = 0; i < 64; ++i)
    grid.push_back({{0.5f * float(i % 4), 0.5f * float(i / 4 % 4), 0.5f * float(i / 16)}, {0.25f, 0.5f, 1.f}});
  const FitState state = initial_fit({}, {}, grid, tiny().views, 1);
  REQUIRE(state.cloud.size() == 64);
  for (std::size_t i = 0; i < 64; ++i) {  // every node of the grid has three neighbours at 0.5
    CHECK(std::exp(state.cloud.log_scale[3 * i]) == doctest::Approx(0.5));
    CHECK(sigmoid(state.cloud.logit_opacity[i]) == doctest::Approx(0.1));
    CHECK(0.5f + 0.2820948f * state.cloud.sh_dc[3 * i] == doctest::Approx(0.25));
  }
}

TEST_CASE("a fit in a small world starts as in a large one, up to the scale") {
  std::vector<FitPoint> grid;
  for (int i = 0; i < 64; ++i)
    grid.push_back({{0.1f * float(i % 4), 0.1f * float(i / 4 % 4), 0.1f * float(i / 16)}, {0.25f, 0.5f, 1.f}});
  std::vector<FitView> views = tiny().views;
  const FitState large = initial_fit({}, {}, grid, views, 1);
  CHECK(large.cloud.size() == 64);
  CHECK(fit_world_unit(views) == 1);
  for (FitView& view : views) view.camera.translation = 1e-3 * view.camera.translation;
  for (FitPoint& point : grid)
    for (float& x : point.position) x *= 1e-3f;
  CHECK(fit_world_unit(views) < 0.01);
  const FitState small = initial_fit({}, {}, grid, views, 1);
  CHECK(std::exp(small.cloud.log_scale[0] - large.cloud.log_scale[0]) == doctest::Approx(1e-3).epsilon(1e-4));
  CHECK(initial_fit({}, {.random_points = 100}, {}, views, 1).cloud.size() == 100);
}

TEST_CASE("initial_fit fails if most points are nearer than the near plane") {
  const std::vector<FitView> one(tiny().views.begin(), tiny().views.begin() + 1);  // no distance to derive a unit from
  const Camera& camera = one[0].camera;
  const Vec3<double> ahead =
      camera.centre() + 0.1 * Vec3<double>{camera.rotation(2, 0), camera.rotation(2, 1), camera.rotation(2, 2)};
  const std::vector<FitPoint> points(8, {{float(ahead.x), float(ahead.y), float(ahead.z)}, {0.5f, 0.5f, 0.5f}});
  test::refused([&] { initial_fit({}, {}, points, one, 1); }, ErrorCode::kInconsistent, "", "scale up the world");
}

TEST_CASE("initial_fit samples the full list if there are more points than max_gaussians") {
  std::vector<FitPoint> points;
  for (int i = 0; i < 64; ++i) points.push_back({{float(i % 8) / 8, float(i / 8) / 8, 0}, {0.5f, 0.5f, 0.5f}});
  const FitState state = initial_fit({}, {.max_gaussians = 16}, points, tiny().views, 1);
  REQUIRE(state.cloud.size() == 16);
  const std::vector<float>& at = state.cloud.position;
  CHECK(std::count_if(at.begin(), at.end(), [](float v) { return v >= 0.5f; }) > 8);
  CHECK(at[0] == 0);
  CHECK(at[3 * 15 + 1] == 0.875f);  // of the last row
}

TEST_CASE("initial_fit accepts one point, coincident points and none") {
  const FitPoint one{{1, 2, 3}, {0, 0, 0}};
  const std::vector<FitPoint> single{one}, coincident(5, one);
  for (const auto& points : {single, coincident}) {
    const FitState state = initial_fit({}, {}, points, tiny().views, 1);
    CHECK(state.cloud.size() == std::int64_t(points.size()));
    for (const float s : state.cloud.log_scale) CHECK(std::isfinite(s));
  }
  const FitState random = initial_fit({}, {.random_points = 100}, {}, tiny().views, 1);
  CHECK(random.cloud.size() == 100);
  int seen = 0;  // the cube is in view
  for (std::size_t i = 0; i < 100; ++i) {
    const Camera& camera = tiny().views[0].camera;
    const float* p = &random.cloud.position[3 * i];
    seen += (camera.rotation * Vec3<double>{double(p[0]), double(p[1]), double(p[2])} + camera.translation).z > 0;
  }
  CHECK(seen > 60);
  const std::vector<FitPoint> bad{{{1, std::numeric_limits<float>::quiet_NaN(), 0}, {0, 0, 0}}};
  CHECK_THROWS_AS(initial_fit({}, {}, bad, tiny().views, 1), Error);
}

TEST_CASE("densification clones small, splits large and prunes faint Gaussians") {
  FitState state = three();
  state.gradient_sum = {1.f, 1.f, 0.f};
  state.cloud.logit_opacity[2] = -10;
  const DensityChange change = densify_and_prune({}, state, {.gradient = 0.5, .dense_scale = 0.01}, 3);
  CHECK(change.cloned == 1);
  CHECK(change.split == 1);
  CHECK(change.pruned == 1);
  REQUIRE(state.cloud.size() == 4);  // 1, its clone, two children of 0
  CHECK(state.cloud.position[0] == 1.f);
  CHECK(state.cloud.position[3] == 1.f);
  CHECK(state.cloud.log_scale[6] == doctest::Approx(-std::log(1.6)));
  CHECK(state.cloud.position[6] != state.cloud.position[9]);
  CHECK(state.moments[kGroupPosition].m == std::vector<float>{2, 2, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  CHECK(state.gradient_sum == std::vector<float>(4, 0.f));
  CHECK(state.cloud.usable.size() == 4);
  CHECK(state.cloud.sh_rest.size() == 4 * 9);
}

TEST_CASE("the gradient threshold applies to the mean over the views in which the Gaussian is visible") {
  FitState state = three();
  state.gradient_sum = {3.f, 3.f, 3.f};
  state.gradient_views = {2.f, 4.f, 0.f};  // means 1.5, 0.75, none
  CHECK(densify_and_prune({}, state, {.gradient = 1, .dense_scale = 10}, 3).cloned == 1);
}

TEST_CASE("densification at max_gaussians uses the largest gradients first") {
  FitState state = three();
  state.gradient_sum = {1.f, 3.f, 2.f};
  const DensityChange change =
      densify_and_prune({}, state, {.gradient = 0.5, .dense_scale = 10, .max_gaussians = 5}, 3);
  CHECK(change.cloned == 2);
  REQUIRE(state.cloud.size() == 5);
  CHECK(state.cloud.position[9] == 1.f);
  CHECK(state.cloud.position[12] == 2.f);
}

TEST_CASE("pruning by size and opacity never removes the last Gaussian") {
  FitState state = three();
  const DensityChange change = densify_and_prune({}, state, {.gradient = 9, .max_scale = 1e-6}, 3);
  CHECK(change.pruned == 2);
  CHECK(state.cloud.size() == 1);
}

TEST_CASE("split children are drawn from their parent's distribution") {
  // A flat parent (1, 0.1, 0.01) turned by 90 degrees about z: its longest axis points along world y.
  double sum[3] = {0, 0, 0};
  const int count = 4000;
  FitState state;
  state.cloud.resize(count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    state.cloud.rotation[4 * i] = state.cloud.rotation[4 * i + 3] = 2.f;  // not normalised
    state.cloud.log_scale[3 * i + 1] = std::log(0.1f);
    state.cloud.log_scale[3 * i + 2] = std::log(0.01f);
  }
  state.gradient_sum.assign(count, 1.f);
  state.gradient_views.assign(count, 1.f);
  densify_and_prune({}, state, {.gradient = 0.5, .dense_scale = 0.001}, 7);
  REQUIRE(state.cloud.size() == 2 * count);
  for (std::size_t i = 0; i < 2 * count; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      sum[k] += double(state.cloud.position[3 * i + k]) * double(state.cloud.position[3 * i + k]);
  const double want[3] = {0.1, 1, 0.01};
  for (std::size_t k = 0; k < 3; ++k)  // relative spread of a variance of n draws: sqrt(2/n) = 1.6 %
    CHECK(std::sqrt(sum[k] / (2 * count)) == doctest::Approx(want[k]).epsilon(4 * 0.008));
}

TEST_CASE("a fit of the tiny scene has a higher PSNR than photos at a quarter of their size") {
  FitOptions options{.steps = 400, .sh_degree = 1, .max_gaussians = 2500};
  const FitState done = run(options, 2, options.steps, start(options));
  double quarter = 0, count = 0;
  for (const FitView& view : tiny().views)
    if (view.split == Split::kTrain) {
      quarter += quarter_size_psnr_db(view.photo.rgb());
      ++count;
    }
  quarter /= count;
  const FitScore before = score_fit({}, options, start(options).cloud, tiny().views, Split::kTrain);
  const FitScore train = score_fit({}, options, done.cloud, tiny().views, Split::kTrain);
  const FitScore held_out = score_fit({}, options, done.cloud, tiny().views, Split::kHeldOut);
  MESSAGE("start " << before.psnr_db << " dB, train " << train.psnr_db << " dB, held out " << held_out.psnr_db
                   << " dB, photos of a quarter of the size " << quarter << " dB");
  CHECK(train.views == 10);
  CHECK(held_out.views == 2);
  CHECK(train.psnr_db > quarter);
  CHECK(train.psnr_db > before.psnr_db + 8);
  CHECK(held_out.psnr_db > before.psnr_db + 4);
}

TEST_CASE("a fit is bit-identical for any thread count, and differs for another seed") {
  FitOptions options{.steps = 40, .sh_degree = 1};
  const FitState one = run(options, 1, 40, start(options));
  CHECK(same(one.cloud, run(options, 2, 40, start(options)).cloud));
  Fitter other(options, tiny().views, start(options), 6);
  for (int i = 0; i < 40; ++i) other.step({});
  CHECK_FALSE(same(one.cloud, other.state().cloud));
}

TEST_CASE("a fit without a training view is an error") {
  std::vector<FitView> views{tiny().views[2]};
  REQUIRE(views[0].split == Split::kHeldOut);
  CHECK_THROWS_AS(Fitter({}, views, start({}), 1), Error);
}

}  // namespace ngs
