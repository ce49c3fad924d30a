// The gradient of the whole field, as joint steps use it: network, tables and features. Mutants this kills: a block
// without its gradient, a feature gradient although f_inter conditions nothing.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "ngs/cut/training/joint_field.h"
#include "ngs/ops/neighbours/knn.h"
#include "support/adjoint.h"
#include "support/random.h"

namespace ngs {
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
    shape.hidden = 16, shape.layers = 2, shape.width = 0.25, shape.neighbours = 4;
    shape.film = film, shape.boundary = kBoundary;
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
