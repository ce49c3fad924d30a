#include "ngs/edit/extract/extract_stage.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ngs/core/error.h"
#include "ngs/core/rng.h"
#include "ngs/edit/extract/import_stage.h"
#include "support/error_code.h"

namespace ngs {
namespace {

/// Gaussians on the x axis, scale e^-5.
GaussianCloud on_a_line(const std::vector<float>& x) {
  GaussianCloud cloud;
  cloud.resize(std::int64_t(x.size()), 0);
  for (std::size_t i = 0; i < x.size(); ++i) {
    cloud.position[i * 3] = x[i];
    for (std::size_t a = 0; a < 3; ++a) cloud.log_scale[i * 3 + a] = -5;
  }
  classify(cloud);
  return cloud;
}

LabelColumns labels_of(std::vector<float> prob, std::vector<float> views = {}) {
  LabelColumns labels;
  for (const float f : prob) labels.label.push_back(f > 0.5f ? 1.f : 0.f);
  labels.prob = std::move(prob);
  labels.views = std::move(views);
  return labels;
}

using Flags = std::vector<std::uint8_t>;

TEST_CASE("the rules are the thresholds of the methods they are named after") {
  CHECK(parse_extract_rule("threshold:0.5").cut == 0.5);
  CHECK(parse_extract_rule("threshold:0.5").inclusive);
  CHECK(parse_extract_rule("sa3d").cut == doctest::Approx(0.231).epsilon(1e-3));
  CHECK(parse_extract_rule("cob:0.9").cut == 0.9);
  CHECK_FALSE(parse_extract_rule("cob:0.9").on_prob);
  const struct {
    double gamma, l2, l1;
  } table[] = {{-0.8, 0.157, 0.10},  {-0.7, 0.215, 0.15}, {0, 0.5, 0.5}, {0.4, 0.647, 0.70},
               {0.75, 0.813, 0.875}, {1, 1, 1},           {-1, 0, 0}};
  for (const auto& row : table) {
    CHECK(parse_extract_rule("flash:" + std::to_string(row.gamma)).cut == doctest::Approx(row.l1));
    CHECK(std::abs(parse_extract_rule("flash-l2:" + std::to_string(row.gamma)).cut - row.l2) < 5e-4);
  }
  for (const char* rule : {"", "threshold", "threshold:", "threshold:2", "threshold:nan", "threshold:0.5x",
                           "flash:-1.1", "sa3d:1", "knn:3"}) {
    CAPTURE(rule);
    CHECK(test::code_of([&] { parse_extract_rule(rule); }) == ErrorCode::kUsage);
  }
}

TEST_CASE("a rule compares its own column, or the other one if that is missing") {
  const GaussianCloud cloud = on_a_line({0, 1, 2, 3});
  LabelColumns labels = labels_of({0.2f, 0.3f, 0.5f, 0.9f});
  labels.label = {0, 1, 0.5f, 0};
  const auto object = [&](const std::string& rule, ScoreColumn score, const LabelColumns& l) {
    return extract_object({}, {.rule = rule, .score = score}, {cloud, l}).object;
  };
  CHECK(object("threshold:0.5", ScoreColumn::kAuto, labels) == Flags{0, 1, 1, 0});
  CHECK(object("threshold:0.5", ScoreColumn::kProb, labels) == Flags{0, 0, 1, 1});
  CHECK(object("sa3d", ScoreColumn::kAuto, labels) == Flags{0, 1, 1, 1});
  CHECK(object("flash:0", ScoreColumn::kAuto, labels) == Flags{0, 0, 0, 1});  // a tie is background
  CHECK(object("cob:0.9", ScoreColumn::kLabel, labels) == Flags{0, 1, 0, 0});
  LabelColumns only_label;
  only_label.label = labels.label;
  CHECK(object("sa3d", ScoreColumn::kAuto, only_label) == Flags{0, 1, 1, 0});
  CHECK_THROWS_AS(object("sa3d", ScoreColumn::kAuto, {}), Error);
}

TEST_CASE("unseen Gaussians are labelled by the chosen rule") {
  // Unseen: row 2 among objects, row 5 among background, row 6 far away. Row 7 is unusable.
  GaussianCloud cloud = on_a_line({0, 1, 0.5f, 10, 11, 10.5f, 90, 0.25f});
  cloud.log_scale[7 * 3] = std::numeric_limits<float>::infinity();
  classify(cloud);
  const LabelColumns labels = labels_of({1, 1, 0, 0, 0, 0, 0, 1}, {3, 3, 0, 2, 2, 0, 0, 3});
  ExtractOptions options{.unseen_neighbours = 3};
  const Extraction knn = extract_object({}, options, {cloud, labels});
  CHECK(knn.object == Flags{1, 1, 1, 0, 0, 0, 0, 0});
  CHECK(knn.unseen == 3);
  CHECK(knn.unseen_to_object == 1);
  CHECK(knn.unusable == 1);
  CHECK(knn.objects == 3);
  options.unseen = UnseenRule::kObject;
  CHECK(extract_object({}, options, {cloud, labels}).object == Flags{1, 1, 1, 0, 0, 1, 1, 0});
  options.unseen = UnseenRule::kBackground;
  CHECK(extract_object({}, options, {cloud, labels}).object == Flags{1, 1, 0, 0, 0, 0, 0, 0});
}

TEST_CASE("unseen Gaussians far from all seen ones stay background") {
  std::vector<float> x, views;
  for (int i = 0; i < 100; ++i) {  // an object
    x.push_back(0.01f * float(i));
    views.push_back(i == 50 ? 0.f : 3.f);
  }
  for (int i = 0; i < 1000; ++i) {  // another room
    x.push_back(5 + 0.01f * float(i));
    views.push_back(0);
  }
  const Extraction found = extract_object({}, {}, {on_a_line(x), labels_of(std::vector<float>(x.size(), 1.f), views)});
  CHECK(found.unseen == 1001);
  CHECK(found.unseen_to_object == 1);  // the one among seen Gaussians
  CHECK(found.object[50] == 1);
  CHECK(found.objects == 100);
}

TEST_CASE("the neighbours of a large unseen Gaussian may be farther away than those of a small one") {
  for (const float scale : {0.2f, 0.01f}) {
    std::vector<float> x, views;
    for (int i = 0; i < 100; ++i) {  // spacing of the 8th: 0.04
      x.push_back(0.01f * float(i));
      views.push_back(3);
    }
    x.push_back(1.3f);
    views.push_back(0);
    GaussianCloud cloud = on_a_line(x);
    for (std::size_t a = 0; a < 3; ++a) cloud.log_scale[3 * 100 + a] = std::log(scale);
    const Extraction found = extract_object({}, {}, {cloud, labels_of(std::vector<float>(x.size(), 1.f), views)});
    CHECK(found.object[100] == (scale > 0.1f));
  }
}

TEST_CASE("a model without seen Gaussians has no voters and no object") {
  const GaussianCloud cloud = on_a_line({0, 1});
  const Extraction e = extract_object({}, {}, {cloud, labels_of({1, 1}, {0, 0})});
  CHECK(e.objects == 0);
  CHECK(e.unseen == 2);
  const GaussianCloud nothing = on_a_line({});
  CHECK(extract_object({}, {}, {nothing, {}}).objects == 0);
}

TEST_CASE("hand-made labels are final") {
  const GaussianCloud cloud = on_a_line({0, 1, 2, 50});
  LabelColumns labels = labels_of({1, 1, 0, 0}, {1, 1, 0, 1});
  labels.label = {0, 1, 1, 1};
  const std::vector<float> fixed = {1, 0, 1, 1};
  const Extraction e = extract_object({}, {.min_component = 2}, {cloud, labels, fixed});
  CHECK(e.object == Flags{0, 1, 1, 1});  // row 2 unseen but fixed, row 3 alone but fixed
  CHECK(e.fixed == 3);
  CHECK(e.unseen == 0);
}

TEST_CASE("components are numbered by their first row and small ones are removed") {
  std::vector<float> x;
  for (int i = 0; i < 20; ++i) x.push_back(0.01f * float(i));
  for (int i = 0; i < 5; ++i) x.push_back(5 + 0.01f * float(i));
  x.push_back(9);
  const GaussianCloud cloud = on_a_line(x);
  std::vector<float> prob(x.size(), 1.f);
  prob[3] = 0;
  const Extraction e = extract_object({}, {.min_component = 5, .component_neighbours = 2}, {cloud, labels_of(prob)});
  CHECK(e.components == 3);
  CHECK(e.removed_components == 1);
  CHECK(e.removed == 1);
  CHECK(e.objects == 24);
  const std::vector<std::int32_t> component = connected_components({}, cloud, Flags(x.size(), 1), 2);
  CHECK(component[0] == 0);
  CHECK(component[20] == 1);
  CHECK(component[25] == 2);
  CHECK(connected_components({}, cloud, Flags(x.size(), 0), 2) == std::vector<std::int32_t>(x.size(), -1));
}

GaussianCloud random_cloud(std::int64_t n) {
  GaussianCloud cloud;
  cloud.resize(n, 0);
  std::uint64_t at = 0;
  const auto fill = [&](std::vector<float>& column) {
    for (float& v : column) v = float(rng_uniform(3, RngStream::kTest, at++));
  };
  fill(cloud.position);
  fill(cloud.sh_dc);
  fill(cloud.logit_opacity);
  classify(cloud);
  return cloud;
}

GaussianCloud rows_of(const GaussianCloud& from, const std::vector<std::size_t>& rows) {
  GaussianCloud cloud;
  cloud.resize(std::int64_t(rows.size()), 0);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t a = 0; a < 3; ++a) {
      cloud.position[r * 3 + a] = from.position[rows[r] * 3 + a];
      cloud.sh_dc[r * 3 + a] = from.sh_dc[rows[r] * 3 + a];
    }
    cloud.logit_opacity[r] = from.logit_opacity[rows[r]];
  }
  return cloud;
}

TEST_CASE("rows in an edit become object, deleted object rows background, others stay free") {
  const GaussianCloud cloud = random_cloud(6);
  const Flags object = {1, 1, 1, 0, 0, 0};
  const std::vector<float> label = {0.9f, 0.8f, 0.7f, 0.1f, 0.2f, 0.3f};
  // The user deleted row 1 and added row 4; rows are reordered.
  const ImportedEdit e = import_edit(cloud, object, label, rows_of(cloud, {4, 2, 0}), {});
  CHECK(e.label == std::vector<float>{1, 0, 1, 0.1f, 1, 0.3f});
  CHECK(e.fixed == std::vector<float>{1, 1, 1, 0, 1, 0});
  CHECK(e.matched == 3);
  CHECK(e.to_object == 1);
  CHECK(e.to_background == 1);
}

TEST_CASE("selected rows of an edit become object, deleted rows background") {
  const GaussianCloud cloud = random_cloud(4);
  const GaussianCloud edit = rows_of(cloud, {3, 2, 1, 0});
  const std::vector<float> label = {1, 1, 0, 0};
  const ImportedEdit selected = import_edit(cloud, {1, 1, 0, 0}, label, edit, {1, 0, 5, 3});
  CHECK(selected.label == std::vector<float>{1, 0, 0, 1});
  CHECK(selected.fixed == std::vector<float>{1, 1, 1, 1});
  const ImportedEdit deleted = import_edit(cloud, {1, 1, 0, 0}, label, edit, {4, 4, 4, 0});  // nothing selected
  CHECK(deleted.label == std::vector<float>{1, 0, 0, 0});
}

TEST_CASE("an edit with all rows and no selection is an error: all would become object") {
  const GaussianCloud cloud = random_cloud(4);
  const GaussianCloud edit = rows_of(cloud, {3, 2, 1, 0});
  const std::vector<float> label = {1, 1, 0, 0};
  const Flags object = {1, 1, 0, 0};
  for (const std::vector<std::uint8_t>& state : {std::vector<std::uint8_t>{}, {0, 0, 2, 0}}) {
    test::refused([&] { import_edit(cloud, object, label, edit, state); }, ErrorCode::kInconsistent, "",
                  "select the object in the editor");
  }
  GaussianCloud broken = cloud;  // an export omits non-finite rows
  broken.usable[0] = 0;
  CHECK_THROWS_AS(import_edit(broken, object, label, rows_of(cloud, {3, 2, 1}), {}), Error);
  CHECK(import_edit(cloud, {1, 1, 1, 1}, label, edit, {}).to_object == 0);  // no change
  CHECK(import_edit(cloud, object, label, edit, {0, 0, 0, 4}).to_object == 2);
  CHECK(import_edit(cloud, object, label, edit, {1, 1, 1, 1}).by_selection);
}

TEST_CASE("Gaussians at one position are matched by opacity and colour, then in row order") {
  GaussianCloud cloud = random_cloud(5);
  for (std::size_t i = 1; i < 4; ++i)
    for (std::size_t a = 0; a < 3; ++a) cloud.position[i * 3 + a] = cloud.position[a];
  const Flags object(5, 1);
  const std::vector<float> label(5, 1.f);
  CHECK(import_edit(cloud, object, label, rows_of(cloud, {2, 0, 4}), {}).label == std::vector<float>{1, 0, 1, 0, 1});
  GaussianCloud repainted = rows_of(cloud, {2, 0, 4});
  repainted.sh_dc[0] = 7;  // no exact match: gets the first remaining row at the position
  const ImportedEdit e = import_edit(cloud, object, label, repainted, {});
  CHECK(e.matched == 3);
  CHECK(std::count(e.label.begin(), e.label.end(), 1.f) == 3);
  CHECK(e.label[0] == 1);
  CHECK(e.label[4] == 1);
}

TEST_CASE("an edit that a converter turned is matched after turning it back, and one without rows is an error") {
  GaussianCloud cloud = random_cloud(40);
  std::fill(cloud.log_scale.begin(), cloud.log_scale.end(), -5.f);
  const Flags object(40, 1);
  const std::vector<float> label(40, 1.f);
  const GaussianCloud edit = rows_of(cloud, {3, 0, 7, 5});
  const auto turned = [&](std::array<std::size_t, 3> axis, std::array<float, 3> sign, float rounding) {
    GaussianCloud out = edit;
    for (std::size_t i = 0; i < out.position.size(); i += 3)
      for (std::size_t k = 0; k < 3; ++k)
        out.position[i + k] = sign[k] * edit.position[i + axis[k]] + (i % 2 == 0 ? rounding : -rounding);
    return import_edit(cloud, object, label, out, {});
  };
  const ImportedEdit plain = import_edit(cloud, object, label, edit, {});
  CHECK(plain.turned.empty());
  for (const float rounding : {0.f, 1e-5f}) {
    CHECK(turned({0, 1, 2}, {1, -1, -1}, rounding).turned == "by 180 degrees about x");
    CHECK(turned({0, 1, 2}, {-1, -1, 1}, rounding).turned == "by 180 degrees about z");
    CHECK(turned({0, 1, 2}, {-1, 1, -1}, rounding).turned == "by 180 degrees about y");
    CHECK(turned({0, 2, 1}, {1, -1, 1}, rounding).turned == "by 90 degrees about x");  // (x, y, z) -> (x, -z, y)
    CHECK(turned({0, 2, 1}, {1, 1, -1}, rounding).turned == "by -90 degrees about x");
    CHECK(turned({0, 2, 1}, {1, 1, -1}, rounding).label == plain.label);
  }
  test::refused([&] { import_edit(cloud, object, label, rows_of(cloud, {}), {}); }, ErrorCode::kNothingFound,
                "contains no Gaussian");
}

TEST_CASE("a moved edit is an error, a few unknown rows in it are not") {
  const GaussianCloud cloud = random_cloud(4);
  const Flags object(4, 1);
  const std::vector<float> label(4, 1.f);
  GaussianCloud edit = rows_of(cloud, {0, 1, 2, 3});
  edit.position[0] += 1;
  CHECK(import_edit(cloud, object, label, edit, {}).unmatched == 1);
  for (std::size_t i = 0; i < 4; ++i) edit.position[i * 3] = cloud.position[i * 3] + 1;
  CHECK(test::code_of([&] { import_edit(cloud, object, label, edit, {}); }) == ErrorCode::kInconsistent);
}

}  // namespace
}  // namespace ngs
