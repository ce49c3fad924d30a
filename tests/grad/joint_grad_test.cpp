// The gradient of the whole joint loss, Eq. (20), as the trainer computes it in float. It is read from Adam's first
// moments after one step and compared with extrapolated central differences of the reported loss.
//
// Two dependences have no gradient by design: the density weights of L_mask (C19), and the field on positions (C25).
// The first is switched off here; positions are moved with the field switched off. Moving geometry also moves pixels
// across alpha = 1/255, where a contribution starts with a jump that no derivative contains: 1 to 2 per cent
// of the difference.
#include <doctest/doctest.h>

#include <cmath>

#include "ngs/cut/training/joint_trainer.h"
#include "support/adjoint.h"
#include "support/joint_case.h"
#include "support/switches.h"

namespace ngs {
namespace {

struct Group {
  const char* block;  // of JointTrainer::state(); its moments are BLOCK.m
  double step;        // largest change of a parameter
  std::vector<std::string> effect;
  double bound;  // relative, about twice the measured error
};

class Probe {
 public:
  Probe(const test::JointCase& c, const Group& group) : input_(c.input()) {
    options_.steps = 8, options_.off = test::joint_switched(group.effect);
    options_.hash_levels = 3, options_.hash_log2_table = 8, options_.hash_finest = 32;
    options_.mlp_hidden = 16, options_.smooth_points = 64, options_.smooth_step = 0.5;
    sample_.rows = sample_.cols = 10, sample_.depth_samples = 4;
  }
  /// The loss with block += direction · t. `gradient`: receives the gradient of `block` after the step.
  double loss(const std::string& block, const std::vector<double>& direction, double t,
              std::vector<double>* gradient) const {
    Monitor monitor;
    JointTrainer trainer({}, monitor, {options_, sample_, rbf_, input_, nullptr}, false);
    for (const StateBlock& b : trainer.state())
      if (b.name == block)
        for (std::size_t i = 0; i < direction.size(); ++i)
          (*b.values)[i] = float(double((*b.values)[i]) + t * direction[i]);
    trainer.resume_at(0);
    const double total = trainer.step().loss.total;
    if (gradient) *gradient = first_moment(trainer, block);
    return total;
  }

 private:
  /// m = (1 - β₁) g after the first step; the moments of the field's blocks follow each other.
  static std::vector<double> first_moment(JointTrainer& trainer, const std::string& block) {
    std::vector<double> g;
    for (const StateBlock& b : trainer.state())
      if (b.name == block + ".m" || (block == "field" && b.name.starts_with("field.") && b.name.ends_with(".m")))
        for (const float m : *b.values) g.push_back(double(m) * 10);
    return g;
  }
  JointOptions options_;
  SampleOptions sample_;
  RbfOptions rbf_;
  Problem input_;
};

}  // namespace

TEST_CASE("joint: the gradient of the whole loss agrees with extrapolated differences in every parameter group") {
  const auto c = test::joint_case(60, 40);
  const std::string no_density = "density=off";
  const Group groups[] = {{"label", 0.2, {no_density}, 1e-4},
                          {"sh_dc", 0.02, {no_density}, 1e-4},
                          {"log_scale", 0.01, {no_density}, 0.05},
                          {"rotation", 0.01, {no_density}, 0.04},
                          {"logit_opacity", 0.05, {no_density}, 0.01},
                          {"field", 0.02, {no_density}, 1e-3},
                          {"field", 2e-5, {no_density, "align=off"}, 0.04},  // L_smth alone
                          {"position", 0.002, {"nerf=off"}, 0.05}};
  for (const Group& group : groups) {
    CAPTURE(std::string(group.block));
    const Probe probe(*c, group);
    std::vector<double> g;
    probe.loss(group.block, {}, 0, &g);
    double largest = 0, square = 0;
    for (const double x : g) largest = std::max(largest, std::abs(x)), square += x * x;
    REQUIRE(largest > 0);
    std::vector<double> direction = g;  // along the gradient: there rounding and thresholds matter least
    for (double& x : direction) x /= largest;
    const double numeric =
        test::ridders([&](double t) { return probe.loss(group.block, direction, t, nullptr); }, group.step);
    const double difference = test::ridders_difference(numeric, square / largest);
    MESSAGE(std::string(group.block), ": gradient ", square / largest, ", differences ", numeric, ", relative ",
            difference);
    CHECK(difference < group.bound);
  }
}

}  // namespace ngs
