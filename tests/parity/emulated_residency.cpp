// What the device path copies and launches, counted by the emulated device; evidence: emulated_evidence.cpp.
#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <set>

#include "ngs/cut/contours/contour_stage.h"
#include "ngs/cut/contours/refined_masks.h"
#include "ngs/cut/passes/agreement.h"
#include "ngs/cut/passes/exposure/exposure.h"
#include "ngs/cut/passes/floaters/floaters.h"
#include "ngs/cut/passes/mask_outliers/mask_outliers.h"
#include "ngs/cut/training/joint_trainer.h"
#include "ngs/make/fit/fit_stage.h"
#include "ngs/make/fit/photo_refit.h"
#include "parity/traffic.h"
#include "support/joint_case.h"
#include "support/switches.h"

namespace ngs::test {
namespace {

/// Copies `from` and reads it in a child process; the signal that ended it.
int signal_of_read(const float* from) {
  const pid_t child = fork();
  if (child == 0) {
    for (const int signal : {SIGSEGV, SIGBUS}) std::signal(signal, SIG_DFL);
    const volatile float value = *from;
    _exit(value == value ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
}

}  // namespace

TEST_CASE("residency: host code that reads guarded device memory faults") {
  HostLauncher launcher(ThreadOrder::kAscending, true);
  const std::vector<float> host{1.f, 2.f};
  const DeviceBuffer<HostLauncher, float> memory(launcher, host);
  CHECK(signal_of_read(host.data()) == 0);
  CHECK(signal_of_read(memory.data()) != 0);
  std::vector<float> back;
  memory.to(back);
  CHECK(back == host);
}

TEST_CASE("residency: pictures and exposures of many views copy the model once") {
  const auto c = joint_case(600, 400);
  Emulated device(ThreadOrder::kAscending, DeviceSums::kInOrder, true);
  const std::size_t colour_bytes = (c->model.sh_dc.size() + c->model.sh_rest.size()) * sizeof(float);
  const Traffic pictures = traffic_of(device, [&] {
    const SplatOptions splat = prepared_for(device.exec(), {}, c->model);
    for (const SceneView& view : c->scene.views) render(device.exec(), c->model, view.camera, splat, {});
  });
  const Traffic two = traffic_of(device, [&] {
    const SplatOptions splat = prepared_for(device.exec(), {}, c->model);
    for (std::size_t v = 0; v < 2; ++v) render(device.exec(), c->model, c->scene.views[v].camera, splat, {});
  });
  CHECK(pictures.copies - two.copies == 2 * 3);  // per view: number of pairs, colour, opacity
  CHECK(pictures.up_bytes == geometry_bytes(c->model) + colour_bytes);
  const Problem input = c->input();
  const Traffic exposures = traffic_of(device, [&] { view_exposures(device.exec(), input, input.views); });
  CHECK(exposures.up_bytes == pictures.up_bytes);
}

TEST_CASE("residency: labels and flags of a loop over views are copied once") {
  const auto c = joint_case(300, 200);
  for (SceneView& view : c->scene.views) view.image_path = view.camera.name;  // so that photos are used
  Emulated device(ThreadOrder::kAscending, DeviceSums::kInOrder, true);
  Problem input = c->input();
  input.splat = prepared_for(device.exec(), {}, c->model);
  const std::size_t n = std::size_t(c->model.size());
  const auto with_views = [&](std::size_t count) {
    input.views.clear();
    for (std::size_t v = 0; v < count; ++v) input.views.push_back(v % 4);
  };
  const auto pretest = [&] { CHECK(pretest_masks(device.exec(), input).size() == input.views.size()); };
  for (const std::size_t count : {kPretestViews, 2 * kPretestViews}) {
    with_views(count);
    CHECK(traffic_of(device, pretest).up_bytes == n * (sizeof(float) + 1));
  }
  const Solution solution{.cloud = unchanged(c->model), .labels = c->labels};
  const auto agreement = [&] { training_agreement(device.exec(), input, solution); };
  for (const std::size_t count : {1, 4}) {
    with_views(count);
    CHECK(traffic_of(device, agreement).up_bytes == n * sizeof(float));
  }
  FloaterOptions floaters;
  const auto front = [&] { front_opacity(device.exec(), floaters, input); };
  front();  // copies the colours
  floaters.max_views = 2;
  const Traffic two = traffic_of(device, front);
  floaters.max_views = 4;
  const Traffic four = traffic_of(device, front);
  CHECK(four.launches > two.launches);
  const Camera& camera = c->scene.views[0].camera;  // each view has its surface
  CHECK(four.up_bytes - two.up_bytes == 2 * sizeof(float) * std::size_t(camera.width_px * camera.height_px));
}

TEST_CASE("residency: a step of a fit copies a few scalars") {
  const auto c = joint_case(200, 200, 2);
  std::vector<FitView> views;
  for (std::size_t v = 0; v < 4; ++v) views.push_back({c->scene.views[v].camera, c->photos[v], Split::kTrain});
  FitOptions options{.steps = 100, .sh_every = 50, .densify_from = 50, .densify_until = 60};
  FitState state;
  state.cloud = c->model;
  state.gradient_sum.resize(400);
  state.gradient_views.resize(400);
  Emulated device(ThreadOrder::kAscending, DeviceSums::kInOrder, true);
  Fitter fitter(options, views, std::move(state), 3);
  for (int step = 0; step < 4; ++step) fitter.step(device.exec());
  const Traffic step = traffic_of(device, [&] { fitter.step(device.exec()); });
  print("step of a fit", step);
  CHECK(step.up_bytes == 0);
  CHECK(step.down_bytes <= 32);
  CHECK(step.launches <= 20);
}

namespace {

struct StepCase {
  int ball, scale;  // Gaussians of the ball and of the wall, size of the pictures
  bool region, field;
};
struct StepTraffic {
  Traffic traffic;
  std::size_t boundary;  // Gaussians
};

/// A step of the joint optimisation in the second round over the four views.
StepTraffic step_traffic(const StepCase& of) {
  const auto c = joint_case(of.ball, of.ball, of.scale);
  Problem input = c->input();
  for (int i = 0; of.region && i < 2 * of.ball; ++i) input.region.push_back(i < of.ball);
  JointOptions options;
  if (!of.field) options.off = joint_switched({"nerf=off"});
  options.steps = 8;
  options.mlp_hidden = 16;
  options.hash_levels = 3;
  options.hash_log2_table = 12;
  options.smooth_points = 32;
  SampleOptions sample{.rows = 8, .cols = 8, .depth_samples = 4};
  const RbfOptions rbf;
  Monitor monitor;
  Emulated device(ThreadOrder::kAscending, DeviceSums::kInOrder, true);
  JointTrainer trainer(device.exec(), monitor, {.options = options, .sample = sample, .rbf = rbf, .input = input},
                       true);
  for (int step = 0; step < 5; ++step) trainer.step();
  return {traffic_of(device, [&] { trainer.step(); }), std::size_t(trainer.result().figures["boundary"])};
}

}  // namespace

TEST_CASE("residency: a step copies a few scalars, at any size of model and pictures; at most 25 launches") {
  for (const bool region : {false, true}) {
    const Traffic small = step_traffic({200, 1, region, false}).traffic,
                  large = step_traffic({800, 2, region, false}).traffic;
    print(region ? "joint step with a region" : "joint step", large);
    CHECK(small.up_bytes == large.up_bytes);
    CHECK(small.down_bytes == large.down_bytes);
    CHECK(small.copies == large.copies);
    CHECK(large.up_bytes == 0);
    CHECK(large.down_bytes <= 64);
    CHECK(large.launches <= 25);
  }
}

TEST_CASE("residency: a step with the field copies its rays and the boundary's positions, no parameter and no image") {
  const StepTraffic small = step_traffic({200, 1, false, true}), large = step_traffic({800, 2, false, true});
  print("joint step with the field", large.traffic);
  REQUIRE(large.boundary > small.boundary);
  CHECK(large.traffic.up_bytes == small.traffic.up_bytes);
  CHECK(large.traffic.down_bytes - small.traffic.down_bytes == (large.boundary - small.boundary) * 3 * sizeof(float));
  CHECK(large.traffic.copies == small.traffic.copies);
}

TEST_CASE("residency: refined contours of further views copy neither the model nor its labels") {
  const auto c = joint_case(300, 200);
  Problem input = c->input();
  input.load_fine_photo = input.load_photo;
  const ContourOptions contour;
  Emulated device(ThreadOrder::kAscending, DeviceSums::kInOrder, true);
  const auto refine = [&](const std::vector<std::size_t>& views) {
    return traffic_of(device, [&] {
      refine_views(device.exec(), {contour.refine, 4, input}, {input.cloud, input.labels}, views, views);
    });
  };
  const Traffic one = refine({0}), four = refine({0, 1, 2, 3});
  print("refinement of four views", four);
  CHECK(one.up_bytes == geometry_bytes(c->model) + std::size_t(c->model.size()) * sizeof(float));
  CHECK(four.up_bytes == one.up_bytes);
  CHECK(one.down_bytes == 48 * 40 * 2 * sizeof(float) + sizeof(std::int64_t));  // label, opacity, number of pairs
  CHECK(four.down_bytes == 4 * one.down_bytes);
}

TEST_CASE("residency: a step of contour refinement copies a few scalars, with windows of any size") {
  const auto c = joint_case(300, 200);
  for (std::size_t i = 0; i < c->is_ball.size(); ++i)
    for (std::size_t k = 0; k < 3 && c->is_ball[i] > 0; ++k) c->model.log_scale[3 * i + k] += 0.35f;
  Camera& wide = c->scene.views[3].camera;  // shows a smaller ball, so its window is smaller
  wide.fx = wide.fy = 42;
  const RenderedView truth = render({}, c->truth, wide, {}, {.label = {c->is_ball.data(), c->truth.size(), 1}});
  c->photos[3] = truth.colour;
  for (std::size_t p = 0; p < truth.label.data.size(); ++p)
    c->masks[3].target[0][p] = truth.label.data[p] > 0.5f ? 1.f : 0.f;
  Problem input = c->input();
  input.load_fine_photo = input.load_photo;
  const std::size_t views = input.views.size();
  ContourOptions contour{.iterations = 2, .epochs = 4, .refine = {}, .margin_px = 4, .on = {}};
  std::set<int> widths_px;
  for (const RefinedView& view :
       refine_views({}, {contour.refine, contour.margin_px, input}, {c->model, c->labels}, input.views, input.views))
    widths_px.insert(view.window.w);
  REQUIRE(widths_px.size() > 1);
  TrainingOptions training;
  Emulated device(ThreadOrder::kAscending, DeviceSums::kInOrder, true);
  std::vector<Traffic> steps;  // of the rounds after the first, which copies photos and masks
  const auto measure = [&](const JointProgress& progress, JointTrainer&, const auto&) {
    if (progress.step > std::int64_t(views)) steps.push_back(device.launcher.traffic());
    device.launcher.traffic() = {};
    return false;
  };
  const Solution start{.cloud = unchanged(c->model), .labels = c->labels};
  const Solution refined = refine_contours(device.exec(), test::Quiet(), {contour, training, input, measure}, start);
  REQUIRE(refined.figures.at("contour_iterations") == 2);
  REQUIRE(steps.size() == 2 * 3 * views);
  print("step of contour refinement", steps.back());
  // The mean of the last epochs is taken on the host, at the ends of the measured rounds; the last is not copied back.
  CHECK(std::ranges::count_if(steps, [](const Traffic& step) { return step.down_bytes > 64; }) == 2 * 3);
  CHECK(std::ranges::count_if(steps, [](const Traffic& step) { return step.up_bytes > 0; }) == 2 * 2);
  for (const Traffic& step : steps) CHECK(step.launches <= 25);
}

TEST_CASE("residency: a step of the refit after the removal of floaters copies a few scalars") {
  const auto c = joint_case(200, 200);
  const Problem input = c->input();
  std::vector<std::uint8_t> moves(400, 0), trained(400, 0);
  std::fill(trained.begin() + 100, trained.end(), std::uint8_t(1));
  std::fill(moves.begin() + 200, moves.end(), std::uint8_t(1));
  Emulated device(ThreadOrder::kAscending, DeviceSums::kInOrder, true);
  const auto refit = [&](int epochs) {
    return traffic_of(device, [&] {
      GaussianCloud cloud = c->model;
      refit_to_photos(device.exec(), test::Quiet(), {.epochs = epochs}, {input, input.views, moves, trained}, cloud);
    });
  };
  const Traffic two = refit(2), three = refit(3);
  const auto steps = std::int64_t(input.views.size());
  MESSAGE("step of a refit: " << (three.launches - two.launches) / steps << " launches, "
                              << (three.down_bytes - two.down_bytes) / std::size_t(steps) << " bytes down");
  CHECK(three.up_bytes == two.up_bytes);
  CHECK(three.down_bytes - two.down_bytes <= std::size_t(steps) * 32);
  CHECK(three.launches - two.launches <= steps * 20);
}

TEST_CASE("residency: a render without enough device memory throws, releases its memory, and can be repeated") {
  const auto c = joint_case(100, 80);
  Emulated device(ThreadOrder::kAscending, DeviceSums::kInOrder, true);  // aborts if memory is not released
  const Camera& camera = c->scene.views[0].camera;
  RenderRequest request{.label = {c->is_ball.data(), c->model.size(), 1}};
  const RenderedView want = render({}, c->model, camera, {}, request);
  std::int64_t failures = 0;
  for (bool failed = true; failed; failures += failed) {
    device.launcher.limit_allocations(failures);
    failed = false;
    try {
      const RenderedView got = render(device.exec(), c->model, camera, {}, request);
      CHECK(got.label.data == want.label.data);
    } catch (const OutOfDeviceMemory& e) {
      failed = true;
      CHECK(e.code() == ErrorCode::kEnvironment);
    }
  }
  CHECK(failures > 15);
}

TEST_CASE("residency: a trainer without enough device memory throws in any allocation and forgets its arrays") {
  const auto c = joint_case(40, 30);
  Problem input = c->input();
  for (int i = 0; i < 70; ++i) input.region.push_back(i < 40);
  JointOptions options;
  options.off = joint_switched({"nerf=off"});
  options.steps = 2;
  Monitor monitor;
  Emulated device(ThreadOrder::kAscending, DeviceSums::kInOrder);
  const auto train = [&](std::int64_t allocations) {
    device.launcher.limit_allocations(allocations);
    JointTrainer trainer(device.exec(), monitor, {.options = options, .sample = {}, .rbf = {}, .input = input}, true);
    while (!trainer.finished()) trainer.step();
    return *trainer.result().cloud;
  };
  const GaussianCloud want = train(-1);
  std::int64_t failures = 0;
  for (bool failed = true; failed; failures += failed) {
    failed = false;
    try {
      const GaussianCloud got = train(failures);
      CHECK(got.sh_dc == want.sh_dc);
    } catch (const OutOfDeviceMemory&) {
      failed = true;
      for (const std::vector<float>* array : {&c->photos[0].data, &c->masks[0].target[0], &c->model.position})
        CHECK(device.launcher.resident.find(array->data(), sizeof(float)) == nullptr);
    }
  }
  CHECK(failures > 50);
}

}  // namespace ngs::test
