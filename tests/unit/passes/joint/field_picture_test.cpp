#include "ngs/passes/joint/field_picture.h"

#include <doctest/doctest.h>

#include "ngs/passes/joint/joint_stage.h"
#include "ngs/stages/render/render_stage.h"
#include "support/joint_case.h"

namespace ngs {
namespace {

/// A field whose network gives one density everywhere, and grey, with a probability of `object` per object.
FieldModel even_field(const GaussianCloud& cloud, float raw_density, float raw_object) {
  FieldShape shape;
  shape.hash = {1, 1, 3, 2, 2, false};
  shape.box = {{0, 0, 4}, {0.1f, 0.1f, 0.1f}};
  shape.hidden = 16, shape.layers = 1, shape.direction_degree = 0, shape.objects = 1, shape.neighbours = 1;
  shape.boundary = 1;
  FieldModel model{JointField(shape, FieldOptions{}, 1), {}, {}};
  model.boundary.row = {0}, model.boundary.position = {0, 0, 4}, model.boundary.origin = cloud.origin;
  ParamStore& store = model.field.parameters();
  for (const char* head : {"film.head_weight", "object.0.head_weight", "film.head_bias", "object.0.head_bias"})
    for (float& value : store.value_of(store.block(head))) value = 0;
  store.value_of(store.block("film.head_bias"))[0] = raw_density;
  store.value_of(store.block("object.0.head_bias"))[1] = raw_object;
  return model;
}

RenderedView ball_view(const test::JointCase& c) {
  LabelColumns labels = c.labels[0];
  labels.label = labels.prob = c.is_ball;
  const std::vector<LabelColumns> objects{labels};
  return render_labelled({}, {c.truth, objects}, c.scene.views[1].camera, {});
}

}  // namespace

TEST_CASE("field picture: the band holds the pixels within its width of a contour, on both sides") {
  ImageF mask(9, 5, 2);
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 9; ++x) mask.at(x, y, 1) = x >= 5 ? 0.6f : 0.4f;  // the other object shows nowhere
  const std::vector<std::uint8_t> band = contour_band(mask, 2);
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 9; ++x) {
      CAPTURE(x);
      CHECK(band[std::size_t(y * 9 + x)] == (x >= 3 && x <= 6));
    }
}

TEST_CASE("field picture: an opaque field is what its pixels of the band show, the rest stays the splat's") {
  const auto c = test::joint_case();
  FieldModel model = even_field(c->truth, 1e4f, 30.f);
  const RenderedView before = ball_view(*c);
  RenderedView view = before;
  const std::vector<std::uint8_t> band = contour_band(before.label, 2);
  const std::int64_t drawn = blend_field({}, model, {c->scene.views[1].camera, c->truth.origin, 2}, view);
  std::int64_t changed = 0;
  for (std::size_t p = 0; p < band.size(); ++p) {
    const bool grey = view.colour.data[p * 3] == 0.5f && view.colour.data[p * 3 + 2] == 0.5f;
    changed += grey;
    if (grey) {
      CHECK(band[p]);
      CHECK(view.alpha.data[p] == doctest::Approx(1));
      CHECK(view.label.data[p] == doctest::Approx(1));  // the head's second object is nobody's
    } else {
      CHECK(view.label.data[p] == before.label.data[p]);
      CHECK(view.colour.data[p * 3] == before.colour.data[p * 3]);
    }
  }
  CHECK(changed == drawn);
  CHECK(drawn > 50);
}

TEST_CASE("field picture: a transparent field changes nothing") {
  const auto c = test::joint_case();
  FieldModel model = even_field(c->truth, -200.f, 30.f);
  const RenderedView before = ball_view(*c);
  RenderedView view = before;
  CHECK(blend_field({}, model, {c->scene.views[1].camera, c->truth.origin, 2}, view) > 50);
  CHECK(view.colour.data == before.colour.data);
  CHECK(view.label.data == before.label.data);
}

TEST_CASE("field picture: a field without a head for the objects leaves their masks to the splat") {
  const auto c = test::joint_case();
  FieldModel model = even_field(c->truth, 1e4f, 30.f);
  RenderedView view = ball_view(*c);
  ImageF two(view.width_px, view.height_px, 2);
  for (std::size_t p = 0; p < view.label.data.size(); ++p) two.data[p * 2] = view.label.data[p];
  view.label = two;
  CHECK(blend_field({}, model, {c->scene.views[1].camera, c->truth.origin, 2}, view) > 50);
  CHECK(view.label.data == two.data);
}

TEST_CASE("field picture: a field of a model with another origin is refused") {
  const auto c = test::joint_case();
  FieldModel model = even_field(c->truth, 0, 0);
  RenderedView view = ball_view(*c);
  const std::array<double, 3> elsewhere{1, 0, 0};
  CHECK_THROWS_AS(blend_field({}, model, {c->scene.views[1].camera, elsewhere, 2}, view), Error);
}

TEST_CASE("field: a head for the objects learns the masks, and its view is nearer to them than an untrained one's") {
  const auto c = test::joint_case();
  JointOptions options;
  options.steps = 120, options.field_masks = true;
  options.hash_levels = 4, options.hash_log2_table = 10, options.hash_finest = 64, options.mlp_hidden = 16;
  SampleOptions sample;
  sample.rows = sample.cols = 16, sample.depth_samples = 4;
  const RbfOptions rbf;
  Monitor monitor;
  const Problem input = c->input();
  JointTrainer trainer({}, monitor, {options, sample, rbf, input}, false);
  double first = 0, last = 0;
  for (int s = 0; s < 120; ++s) {
    const double loss = trainer.step().loss.field_mask;
    (s < 4 ? first : last) += s < 4 || s >= 116 ? loss / 4 : 0;
  }
  CHECK(first > 0.3);
  CHECK(last < 0.6 * first);
}

}  // namespace ngs
