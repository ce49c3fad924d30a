// The whole field, as the joint steps differentiate it: network, heads of the objects, tables, features, and the
// boundary's positions through Eqs. 8-9 (C25). Mutants this kills: f_inter's part of a concatenated input that is not
// handed back, a head whose density gradient is left out, the second head's objects in the first's outputs, positions
// of the wrong set.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "ngs/ops/field/knn.h"
#include "ngs/passes/joint/joint_field.h"
#include "support/adjoint.h"
#include "support/random.h"

namespace ngs {
namespace {

constexpr int kRays = 12, kSamples = 5, kBoundary = 9;
const Vec3<float> kBehind{0.2f, 0.4f, 0.1f};

struct Variant {
  int features;
  bool concatenate;
  int objects;
};
constexpr Variant kVariants[] = {{3, false, 0}, {3, false, 1}, {5, true, 2}, {8, false, 4}, {4, true, 5}};

/// So that no slope has a kink.
void let_all_neurons_fire(JointField& field) {
  for (const ParamBlock& block : field.parameters().blocks)
    if (block.name.ends_with("beta_bias") || block.name.ends_with("0.bias"))
      for (float& value : field.parameters().value_of(block)) value += 2;
}

/// A field about the unit cube with rays through it, and numbers that its outputs are weighted by.
struct FieldCase {
  std::vector<float> boundary;
  FieldRays rays;
  JointField field;
  AlignFieldGradients align;
  std::vector<float> mask;

  FieldCase(const Variant& v, test::Random& random) : field(shape_of(v), FieldOptions{}, 3) {
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
    let_all_neurons_fire(field);
    align = {floats(kRays * 3, -1, 1), floats(kRays, -1, 1)};
    mask = floats(std::size_t(kRays * v.objects), -1, 1);
  }
  static FieldShape shape_of(const Variant& v) {
    FieldShape shape;
    shape.hash = {2, 2, 6, 4, 8, false};
    shape.box = {{0, 0, 0}, {0.7f, 0.7f, 0.7f}};
    shape.hidden = 16, shape.layers = 2, shape.direction_degree = 1, shape.width = 0.25, shape.neighbours = 4;
    shape.features = v.features, shape.concatenate = v.concatenate, shape.objects = v.objects;
    shape.boundary = kBoundary;
    return shape;
  }
  Rows<const float, 3> positions() const { return {boundary.data(), kBoundary}; }
  double loss() {
    const VolumeOutput& out = field.forward({}, rays, positions(), kBehind);
    double sum = 0;
    for (std::size_t i = 0; i < out.colour.size(); ++i) sum += double(out.colour[i]) * double(align.colour[i]);
    for (std::size_t i = 0; i < out.alpha.size(); ++i) sum += double(out.alpha[i]) * double(align.alpha[i]);
    for (std::size_t i = 0; i < mask.size(); ++i) sum += double(field.mask()[i]) * double(mask[i]);
    return sum;
  }
  void differentiate() {
    loss();
    field.backward({}, rays, positions(), kBehind, {align, mask});
  }
  /// (L(x + h v) - L(x - h v)) / 2h of the values at x.
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

/// f(case, random) for every variant.
template <class F>
void for_each_case(std::uint64_t seed, const F& f) {
  test::Random random(seed);
  for (const Variant& v : kVariants) {
    CAPTURE(v.features);
    CAPTURE(v.concatenate);
    CAPTURE(v.objects);
    FieldCase c(v, random);
    f(c, random);
  }
}

double product(const std::vector<float>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += double(a[i]) * b[i];
  return sum;
}

}  // namespace

TEST_CASE("joint field: backward is the slope of what the field renders, in every block and in the positions") {
  for_each_case(21, [](FieldCase& c, test::Random& random) {
    c.field.want_position_gradient();
    c.differentiate();
    const std::vector<float> grads = c.field.parameters().grads, at_boundary = c.field.position_gradient();
    for (const ParamBlock& block : c.field.parameters().blocks) {
      CAPTURE(block.name);
      std::vector<double> direction(grads.size(), 0.0);
      const std::vector<double> part = random.uniform_vector(block.size, -1, 1);
      std::copy(part.begin(), part.end(), direction.begin() + std::ptrdiff_t(block.offset));
      const double slope = c.difference(c.field.parameters().values, direction, 2e-3);
      CHECK(product(grads, direction) == doctest::Approx(slope).epsilon(0.02).scale(0.1));
    }
    const std::vector<double> direction = random.uniform_vector(c.boundary.size(), -1, 1);
    const double slope = c.difference(c.boundary, direction, 4e-3);
    CHECK(std::abs(slope) > 4e-4);
    CHECK(product(at_boundary, direction) == doctest::Approx(slope).epsilon(0.02).scale(0.02));
  });
}

TEST_CASE("joint field: what the query points and their spacing are asked is the slope of what the field renders") {
  for_each_case(22, [](FieldCase& c, test::Random& random) {
    c.field.want_query_gradient();
    c.differentiate();
    const QueryGradients asked = c.field.query_gradient();
    // Shorter than a cell: where a point crosses a face, the slope of a linear blend jumps.
    const std::vector<double> direction = random.uniform_vector(c.rays.rays.position.size(), -1, 1);
    const double slope = c.difference(c.rays.rays.position, direction, 1e-3);
    CHECK(std::abs(slope) > 4e-4);
    CHECK(product(asked.position, direction) == doctest::Approx(slope).epsilon(0.02).scale(0.02));
    const std::vector<double> wider = random.uniform_vector(c.rays.rays.spacing.size(), -1, 1);
    const double spread = c.difference(c.rays.rays.spacing, wider, 4e-3);
    CHECK(std::abs(spread) > 4e-4);
    CHECK(product(asked.spacing, wider) == doctest::Approx(spread).epsilon(0.02).scale(0.02));
  });
}

namespace {

/// A field whose colour is asked at points, and L_smth of it there.
struct ColourCase {
  GaussianCloud none;
  BoundarySet boundary;
  FieldRays rays;  // a sample each, so long that it is opaque: the rendered colour is the field's
  std::unique_ptr<JointField> field;

  explicit ColourCase(test::Random& random) {
    boundary.position = random.uniform_vector<float>(kBoundary * 3, -0.5, 0.5);
    boundary.colour = random.uniform_vector<float>(kBoundary * 3, 0, 1);
    for (std::uint32_t b = 0; b < kBoundary; ++b) boundary.row.push_back(b);
    JointOptions options;
    options.hash_levels = 2, options.hash_base = 4, options.hash_finest = 8, options.hash_log2_table = 8;
    options.mlp_hidden = 16, options.hash_smoothstep = true;
    options.smooth_points = 1000, options.smooth_step = 0.01, options.smooth_form = SmoothnessForm::kGradient;
    JointSwitches effects;
    effects.fine_hash = true;
    field = std::make_unique<JointField>(
        Exec{},
        JointField::Setup{options, effects, SampleOptions{}, RbfOptions{.neighbours = kBoundary}, none, boundary});
    std::vector<float>& values = field->parameters().values;
    for (float& value : values) value += float(random.uniform(-0.2, 0.2));
    let_all_neurons_fire(*field);
    rays.rays.samples = 1;
    rays.rays.position = random.uniform_vector<float>(60, -0.5, 0.5);
    rays.rays.spacing.assign(20, 1e4f);
    for (int r = 0; r < 20; ++r) rays.rays.direction.insert(rays.rays.direction.end(), {0.6f, 0.f, 0.8f});
    rays.graph = nearest_points({}, boundary.positions(), rays.rays.positions(), kBoundary);
    build_transpose(rays.graph);
    field->want_query_gradient();
  }
  /// The mean of Σ_channels ‖u ∇c‖² by a product with the Jacobian per channel, as the paper has it.
  double squared_gradient() {
    double sum = 0;
    for (std::size_t channel = 0; channel < 3; ++channel) {
      AlignFieldGradients of_channel{std::vector<float>(60, 0.f), std::vector<float>(20, 0.f)};
      for (std::size_t r = 0; r < 20; ++r) of_channel.colour[r * 3 + channel] = 1;
      field->forward({}, rays, boundary.positions(), kBehind);
      field->backward({}, rays, boundary.positions(), kBehind, {of_channel, {}});
      for (const float g : field->query_gradient().position) sum += double(g) * double(g) / 20;
    }
    field->parameters().zero_grads();
    return sum * field->shape().width * field->shape().width;
  }
};

}  // namespace

TEST_CASE("joint field: L_smth in its gradient form is what products with the Jacobian give, and so is its slope") {
  test::Random random(23);
  ColourCase c(random);
  const double want = c.squared_gradient();
  REQUIRE(want > 1e-4);
  const double loss = c.field->smoothness({}, c.rays, c.boundary.positions(), 1, 0);
  MESSAGE("L_smth ", loss, ", by products ", want, ", relative ", loss / want - 1);
  CHECK(loss == doctest::Approx(want).epsilon(5e-4));  // the square of a hundredth of a width, times the curvature
  const std::vector<float> grads = c.field->parameters().grads;
  std::vector<float>& values = c.field->parameters().values;
  const std::vector<float> at = values;
  double most = 0, square = 0;
  for (const float g : grads) most = std::max(most, std::abs(double(g))), square += double(g) * double(g);
  const double h = 5e-4;
  double sides[2];
  for (const int side : {0, 1}) {
    for (std::size_t i = 0; i < at.size(); ++i)
      values[i] = float(double(at[i]) + (side ? -h : h) * double(grads[i]) / most);
    sides[side] = c.squared_gradient();
  }
  MESSAGE("slope uphill ", square / most, ", of the products ", (sides[0] - sides[1]) / (2 * h));
  CHECK(square / most == doctest::Approx((sides[0] - sides[1]) / (2 * h)).epsilon(2e-3));
}

}  // namespace ngs
