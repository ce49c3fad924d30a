// Steps of the joint optimisation on a device: op by op, and with all state resident.
#include <cmath>
#include <limits>
#include <utility>

#include "ngs/core/error.h"
#include "ngs/passes/joint/joint_stage.h"
#include "parity/backends.h"
#include "support/joint_case.h"

namespace ngs::test {
namespace {

struct Setup {
  JointOptions options;
  SampleOptions sample;
  RbfOptions rbf;
  const QueryField* field = nullptr;
  std::vector<std::uint8_t> frozen;
  Setup() {
    options.mlp_hidden = 16, options.hash_levels = 3, options.hash_log2_table = 8, options.smooth_points = 32;
    options.steps = 10;
    sample.rows = sample.cols = 8, sample.depth_samples = 4;
  }
};

struct Run {
  std::vector<LossTerms> losses;
  std::vector<std::string> name;
  std::vector<std::vector<float>> start, state;
};

/// `visit(trainer, step)` after every step; reads losses at each of them, or at none but the last.
template <class Visit>
Run run(const Exec& exec, const JointCase& c, const Setup& s, bool read, const Visit& visit) {
  const Problem input = c.input();
  Monitor monitor;
  JointTrainer trainer(exec, monitor, {s.options, s.sample, s.rbf, input, s.field, {}, s.frozen}, true);
  Run result;
  for (const StateBlock& block : trainer.state()) result.start.push_back(*block.values);
  while (!trainer.finished()) {
    result.losses.push_back(trainer.step(read).loss);
    visit(trainer, trainer.steps_done());
  }
  for (const StateBlock& block : trainer.state()) result.name.push_back(block.name), result.state.push_back(*block.values);
  return result;
}
Run run(const Exec& exec, const JointCase& c, const Setup& s, bool read = true) {
  return run(exec, c, s, read, [](JointTrainer&, std::int64_t) {});
}

/// Checks a block's largest and root mean square difference, in units of how far its values have moved.
void check_block(const Backend& b, const std::string& what, const Run& got, const Run& want, std::size_t block) {
  const std::vector<float>&w = want.state[block], &g = got.state[block], &start = want.start[block];
  REQUIRE(g.size() == w.size());
  double most = 0, squares = 0, most_moved = 0, squares_moved = 0;
  for (std::size_t i = 0; i < w.size(); ++i) {
    const double difference = std::abs(double(g[i]) - double(w[i])), moved = std::abs(double(w[i]) - double(start[i]));
    most = std::isfinite(difference) ? std::max(most, difference) : std::numeric_limits<double>::infinity();
    squares += difference * difference;
    most_moved = std::max(most_moved, moved), squares_moved += moved * moved;
  }
  // With the CPU's exp only roundings of sums differ; with another one the sign of gradients that are nearly zero may, and
  // Adam then takes whole steps the other way.
  check_ratio(b, what + want.name[block] + ", most", most > 0 ? most / most_moved : 0, b.same_functions ? 0.02 : 2);
  check_ratio(b, what + want.name[block] + ", rms", squares > 0 ? std::sqrt(squares / squares_moved) : 0,
              b.same_functions ? 0.001 : 0.1);
}
void check_parameters(const Backend& b, const std::string& what, const Run& got, const Run& want) {
  REQUIRE(got.name == want.name);
  for (std::size_t k = 0; k < want.name.size(); ++k)
    if (want.name[k].find('.') == std::string::npos) check_block(b, what, got, want, k);  // others are moments
}

void check_losses(const Backend& b, const std::string& how, const std::vector<LossTerms>& got,
                  const std::vector<LossTerms>& want) {
  for (std::size_t step = 0; step < want.size(); ++step) {
    // A first step differs by rounding; in L_smth by that of two nearly equal colours. Adam divides by the root of squares:
    // where a gradient is nearly zero, rounding decides its sign, and the next steps start from slightly other parameters.
    const auto term = [&](const char* name, double LossTerms::*member, double first) {
      const double w = want[step].*member, error = std::abs(got[step].*member - w);
      check_ratio(b, how + name + (step == 0 ? ", first step" : ", later steps"), error / (1.2e-7 * std::max(w, 1e-3)),
                  step == 0 ? first : b.same_functions ? 10 * first : 1e5);
    };
    term("align", &LossTerms::align, 100), term("mask", &LossTerms::mask, 100), term("cont", &LossTerms::cont, 100);
    term("smooth", &LossTerms::smooth, 1000), term("photometric", &LossTerms::photometric, 100);
    term("total", &LossTerms::total, 100);
  }
}

}  // namespace

TEST_CASE("joint: the losses of the first steps on a device, op by op, are the CPU's") {
  const auto c = joint_case(60, 40);
  Setup s;
  s.options.steps = 3;
  const Run want = run({}, *c, s);
  for (const Backend& b : backends()) {
    const DeviceOps& all = *b.exec.device_ops;
    const DeviceOps op_by_op(all.splat, all.field, all.loss, nullptr);
    Exec exec = b.exec;
    exec.device_ops = &op_by_op;
    check_losses(b, "joint op by op, ", run(exec, *c, s).losses, want.losses);
  }
}

TEST_CASE("joint: losses and parameters of resident steps are the CPU's") {
  const auto c = joint_case(60, 40);
  const Setup s;  // ten steps: two and a half rounds
  const Run want = run({}, *c, s);
  for (const Backend& b : backends()) {
    const Run got = run(b.exec, *c, s);
    check_losses(b, "joint resident, ", got.losses, want.losses);
    check_parameters(b, "joint resident, 10 steps, ", got, want);
  }
}

TEST_CASE("joint: losses and parameters of resident steps with atomic sums are the CPU's") {
  const auto c = joint_case(60, 40);
  const Setup s;
  const Run want = run({}, *c, s);
  std::vector<Run> got;
  for (const Backend& b : atomic_backends()) {
    got.push_back(run(b.exec, *c, s));
    check_losses(b, "joint resident, atomic sums, ", got.back().losses, want.losses);
    check_parameters(b, "joint resident, atomic sums, 10 steps, ", got.back(), want);
  }
  if (got.size() > 1) CHECK(got[0].state != got[1].state);  // they are summed otherwise
}

TEST_CASE("joint: the bytes of resident steps depend neither on the order of threads nor on when they are looked at") {
  const auto c = joint_case(60, 40);
  c->scene.views[2].camera.width_px = 17;  // lists of tiles outgrow the room that one view gave them
  c->photos[2] = ImageF(17, 40, 3, 0.3f), c->masks[2].available = false;
  const Setup s;
  const Run want = run(backends()[0].exec, *c, s);
  for (const Backend& b : backends()) {
    CAPTURE(b.name);
    CHECK(run(b.exec, *c, s).state == want.state);
    CHECK(run(b.exec, *c, s, false).state == want.state);
    const Run looked_at = run(b.exec, *c, s, false, [](JointTrainer& t, std::int64_t step) {
      if (step == 5) t.state(), t.resume_at(5);
      if (step == 7) t.result();
    });
    CHECK(looked_at.state == want.state);
    if (b.spare_bytes == nullptr) continue;
    const std::int64_t spare = std::exchange(*b.spare_bytes, 0);  // no view stays
    CHECK(run(b.exec, *c, s, false).state == want.state);
    *b.spare_bytes = spare;
  }
}

TEST_CASE("joint: resident steps follow a plan that changes, and the queries of an artifact") {
  const auto c = joint_case(60, 40);
  const Backend& b = backends()[0];
  Setup s;
  const auto shorter = [](JointTrainer& t, std::int64_t step) {
    if (step == 3) t.plan_steps(7);
  };
  const Run want = run({}, *c, s, true, shorter), got = run(b.exec, *c, s, false, shorter);
  CHECK(got.losses.size() == 7);
  check_parameters(b, "joint resident, changed plan, ", got, want);

  const Problem input = c->input();
  std::vector<float> flags(std::size_t(c->model.size()));
  for (std::size_t i = 0; i < flags.size(); ++i) flags[i] = c->labels[0].boundary[i];
  const BoundarySet boundary = boundary_set(c->model, flags);
  Monitor monitor;
  SampleOptions coarse = s.sample;
  coarse.rows = 5, coarse.depth_samples = 3;
  QueryField field = sample_queries({}, monitor, coarse, c->model, boundary, c->scene, input.views, {});
  interpolate_features({}, monitor, s.rbf, c->model, boundary, field);
  s.field = &field;
  s.options.steps = 4;
  const Run given = run({}, *c, s);
  check_losses(b, "joint resident, given queries, ", run(b.exec, *c, s).losses, given.losses);
}

TEST_CASE("joint: every part of the method does on a device what it does on the CPU") {
  const auto c = joint_case(60, 40);
  const Backend& b = backends()[0];
  std::vector<Setup> setups;
  for (const char* effect : {"nerf", "box", "rbf", "hash", "film", "align", "variance", "density", "mask", "cont", "smooth",
                             "photometric", "region", "sh", "geometry", "mask-geometry"})
    setups.emplace_back().options.effect = {std::string(effect) + "=off"};
  setups.emplace_back().options.rate_literal = true;
  setups.emplace_back().options.excess_variance = true;
  setups.emplace_back().options.mask_loss = MaskLossForm::kLinear;
  setups.emplace_back().sample.window = WindowCentre::kMean;
  setups.emplace_back().sample.nodes = GridNodes::kInclusive;
  setups.emplace_back().sample.rows = 300;  // more than there are pixels: rays beyond the grid
  setups.emplace_back().frozen.assign(std::size_t(c->model.size()), 1);
  for (Setup& s : setups) {
    s.options.steps = 6;
    const std::string how = s.options.effect.empty() ? std::string() : s.options.effect[0];
    CAPTURE(how);
    const Run want = run({}, *c, s), got = run(b.exec, *c, s);
    check_losses(b, "joint resident, a part left out, ", got.losses, want.losses);
    check_parameters(b, "joint resident, a part left out, ", got, want);
    if (!s.frozen.empty()) CHECK(got.state[0] == got.start[0]);
  }
}

TEST_CASE("joint: a gradient that is no number ends resident steps with the CPU's error") {
  const auto c = joint_case(60, 40);
  c->photos[1].data[100] = std::numeric_limits<float>::quiet_NaN();
  // Which Gaussian is the first differs: on a device 0 · NaN reaches all of a tile.
  const auto message = [&](const Exec& exec, bool read) -> std::string {
    try {
      run(exec, *c, Setup(), read);
    } catch (const Error& e) {
      CHECK(e.code() == ErrorCode::kNumeric);
      const std::string what = e.what();
      return what.substr(0, what.find("gradient"));
    }
    return {};
  };
  const std::string want = message({}, true);
  REQUIRE(want.find("view1.png") != std::string::npos);
  for (const Backend& b : backends())
    for (const bool read : {true, false}) CHECK(message(b.exec, read) == want);
}

}  // namespace ngs::test
