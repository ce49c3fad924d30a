// The gradient of the whole joint loss, Eq. (20), as the trainer computes it in float. It is read from Adam's first
// moments after one step and compared with extrapolated central differences of the reported loss.
//
// Two dependences have no gradient by design: the density weights of L_mask (C19), and the field on positions (C25).
// The first is switched off here; positions are moved with the field switched off. Moving geometry also moves pixels
// across alpha = 1/255, where a contribution starts with a jump that no derivative contains: 1 to 2 per cent
// of the difference.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "ngs/cut/training/joint_trainer.h"
#include "ngs/field/joint_field.h"
#include "ngs/ops/neighbours/knn.h"
#include "support/adjoint.h"
#include "support/joint_case.h"
#include "support/random.h"
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
    options_.off = test::joint_switched(group.effect);
    options_.smooth_step = 0.5;
    sample_.rows = sample_.cols = 10;
    sample_.depth_samples = 4;
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
  JointOptions options_ = test::small_joint(8, 3, 32);
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
    for (const double x : g) {
      largest = std::max(largest, std::abs(x));
      square += x * x;
    }
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

// The gradient of the whole field, as joint steps use it: network, tables and features. Mutants this kills: a block
// without its gradient, a feature gradient although f_inter conditions nothing.

namespace {

constexpr int kRays = 12, kSamples = 5, kBoundary = 9;
const Vec3<float> kBehind{0.2f, 0.4f, 0.1f};

/// Activates every ReLU, so that the loss has no kinks.
void activate_all_relus(JointField& field) {
  for (const ParamBlock& block : field.parameters().blocks)
    if (block.name.ends_with("beta_bias") || block.name.ends_with("0.bias"))
      for (float& value : field.parameters().value_of(block)) value += 2;
}

/// A field around the unit cube with rays through it, and random weights of its outputs.
struct FieldCase {
  std::vector<float> boundary;
  FieldRays rays;
  JointField field;
  AlignFieldGradients align;

  FieldCase(bool film, test::Random& random) : field(shape_of(film), 3) {
    const auto floats = [&](std::size_t count, double low, double high) {
      const std::vector<double> x = random.uniform_vector(count, low, high);
      return std::vector<float>(x.begin(), x.end());
    };
    boundary = floats(kBoundary * 3, -0.5, 0.5);
    rays.rays.samples = kSamples;
    rays.rays.position = floats(kRays * kSamples * 3, -0.6, 0.6);
    rays.rays.spacing.assign(kRays, 0.3f);
    for (int r = 0; r < kRays; ++r) rays.rays.direction.insert(rays.rays.direction.end(), {0.6f, 0.f, 0.8f});
    rays.graph = nearest_points({}, {boundary.data(), kBoundary}, rays.rays.positions(), 4);
    build_transpose(rays.graph);
    std::vector<float>& values = field.parameters().values;
    const std::vector<float> moved = floats(values.size(), -0.1, 0.1);  // zeros would hide a gradient
    for (std::size_t i = 0; i < values.size(); ++i) values[i] += moved[i];
    activate_all_relus(field);
    align = {floats(kRays * 3, -1, 1), floats(kRays, -1, 1)};
  }
  static FieldShape shape_of(bool film) {
    FieldShape shape;
    shape.hash = {2, 2, 6, 4, 8};
    shape.box = {{0, 0, 0}, {0.7f, 0.7f, 0.7f}};
    shape.hidden = 16;
    shape.layers = 2;
    shape.width = 0.25;
    shape.neighbours = 4;
    shape.film = film;
    shape.boundary = kBoundary;
    return shape;
  }
  Rows<const float, 3> positions() const { return {boundary.data(), kBoundary}; }
  double loss() {
    const VolumeOutput& out = field.forward({}, rays, positions(), kBehind);
    double sum = 0;
    for (std::size_t i = 0; i < out.colour.size(); ++i) sum += double(out.colour[i]) * double(align.colour[i]);
    for (std::size_t i = 0; i < out.alpha.size(); ++i) sum += double(out.alpha[i]) * double(align.alpha[i]);
    return sum;
  }
  void differentiate() {
    loss();
    field.backward({}, rays, positions(), kBehind, align);
  }
  /// (L(x + h v) - L(x - h v)) / 2h at the values x.
  double difference(std::vector<float>& x, const std::vector<double>& v, double h) {
    const std::vector<float> at = x;
    double sides[2];
    for (int side = 0; side < 2; ++side) {
      for (std::size_t i = 0; i < x.size(); ++i) x[i] = float(double(at[i]) + (side == 0 ? h : -h) * v[i]);
      sides[side] = loss();
    }
    x = at;
    return (sides[0] - sides[1]) / (2 * h);
  }
};

double product(const std::vector<float>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += double(a[i]) * b[i];
  return sum;
}

}  // namespace

TEST_CASE("joint field: backward agrees with central differences of the rendered field in every block") {
  test::Random random(21);
  for (const bool film : {true, false}) {
    CAPTURE(film);
    FieldCase c(film, random);
    c.differentiate();
    const std::vector<float> grads = c.field.parameters().grads;
    for (const ParamBlock& block : c.field.parameters().blocks) {
      CAPTURE(block.name);
      std::vector<double> direction(grads.size(), 0.0);
      const std::vector<double> part = random.uniform_vector(block.size, -1, 1);
      std::copy(part.begin(), part.end(), direction.begin() + std::ptrdiff_t(block.offset));
      const double slope = c.difference(c.field.parameters().values, direction, 2e-3);
      CHECK(product(grads, direction) == doctest::Approx(slope).epsilon(0.02).scale(0.1));
      if (film && block.name == "feature") CHECK(std::abs(slope) > 4e-4);
    }
  }
}

}  // namespace ngs
