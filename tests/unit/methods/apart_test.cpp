#include "ngs/methods/apart.h"

#include <doctest/doctest.h>

#include <optional>

#include "ngs/core/error.h"

namespace ngs {
namespace {

using RowList = std::vector<std::int64_t>;
using Sets = std::vector<std::vector<std::size_t>>;

/// Columns of an object with these probabilities; `boundary` rows are its boundary set.
LabelColumns object_of(std::vector<float> prob, const std::vector<std::size_t>& boundary = {}) {
  const std::size_t n = prob.size();
  LabelColumns c{prob, prob, std::vector<float>(n), std::vector<float>(n, 3.f), std::vector<float>(n)};
  for (const std::size_t row : boundary) c.boundary[row] = 1;
  return c;
}

/// n Gaussians of degree 1 whose every value tells the row.
GaussianCloud cloud_of(std::int64_t n) {
  GaussianCloud cloud;
  cloud.resize(n, 1);
  for (auto* column : {&cloud.position, &cloud.rotation, &cloud.log_scale, &cloud.logit_opacity, &cloud.sh_dc,
                       &cloud.sh_rest})
    for (std::size_t i = 0; i < column->size(); ++i) (*column)[i] = 0.125f * float(i);
  return cloud;
}

/// The model's rows `source`, as a part of object `object` holds them; labels are 0.5 and the row's number.
struct Part {
  GaussianCloud cloud;
  RowList source;
  LabelColumns labels;
  std::size_t object;

  Part(const GaussianCloud& model, RowList rows, std::size_t of) : source(std::move(rows)), object(of) {
    cloud.sh_degree = model.sh_degree;
    cloud.resize(std::int64_t(source.size()), model.sh_degree);
    std::vector<float> prob;
    for (std::size_t r = 0; r < source.size(); ++r) {
      const auto from = std::size_t(source[r]);
      std::copy_n(&model.position[from * 3], 3, &cloud.position[r * 3]);
      std::copy_n(&model.rotation[from * 4], 4, &cloud.rotation[r * 4]);
      std::copy_n(&model.log_scale[from * 3], 3, &cloud.log_scale[r * 3]);
      cloud.logit_opacity[r] = model.logit_opacity[from];
      std::copy_n(&model.sh_dc[from * 3], 3, &cloud.sh_dc[r * 3]);
      std::copy_n(&model.sh_rest[from * 9], 9, &cloud.sh_rest[r * 9]);
      prob.push_back(float(100 * of + r));
    }
    labels = object_of(prob);
  }
  ModelPart view() const { return {"part" + std::to_string(object), &cloud, &source, {object}, {labels}}; }
};

/// What joining throws; nothing where it does not.
std::optional<ErrorCode> code_of(const GaussianCloud& model, std::size_t objects, const std::vector<ModelPart>& parts) {
  const std::vector<LabelColumns> labels(objects, object_of(std::vector<float>(std::size_t(model.size()))));
  try {
    join_parts(model, labels, parts);
  } catch (const Error& e) {
    return e.code();
  }
  return std::nullopt;
}

}  // namespace

TEST_CASE("objects meet where a Gaussian is several objects' own, and by way of others") {
  CHECK(objects_that_meet({}).empty());
  CHECK(objects_that_meet({object_of({})}) == Sets{{0}});
  // Rows: 0 of object 0; 1 boundary of 0 and 3; 2 inside 3, boundary of 1; 3 of object 2; 4 a little of 0 and 2.
  const std::vector<LabelColumns> objects{object_of({1, 0, 0, 0, 0.4f}, {1}), object_of({0, 0, 0.3f, 0, 0}, {2}),
                                          object_of({0, 0, 0, 1, 0.4f}), object_of({0, 0, 0.9f, 0, 0}, {1})};
  CHECK(objects_that_meet(objects) == Sets{{0, 1, 3}, {2}});
}

TEST_CASE("a run apart holds what is another's own, what nobody owns, and what two have a little of") {
  const std::vector<LabelColumns> objects{object_of({0.9f, 0.2f, 0.2f, 0.2f, 0, 0.01f}, {4}),
                                          object_of({0.2f, 0.9f, 0, 0.2f, 0, 0.01f}, {})};
  using Held = std::vector<std::uint8_t>;
  CHECK(held_rows(objects, {0}) == Held{0, 1, 0, 1, 0, 1});
  CHECK(held_rows(objects, {1}) == Held{1, 0, 1, 1, 1, 1});
  CHECK(held_rows(objects, {0, 1}) == Held{0, 0, 0, 0, 0, 1});
  CHECK(held_rows({}, {}).empty());
  // No Gaussian is free in two runs.
  const Held a = held_rows(objects, {0}), b = held_rows(objects, {1});
  for (std::size_t i = 0; i < a.size(); ++i) CHECK((a[i] || b[i]));
}

TEST_CASE("joined parts have what each of them changed, and the model's rest") {
  const GaussianCloud model = cloud_of(5);
  Part first(model, {0, 1, 2, 3, 4}, 0), second(model, {0, 1, 2, 3, 4}, 1);
  first.cloud.sh_rest[1 * 9 + 8] = -1;    // the last value of a row
  second.cloud.position[3 * 3] = -2;
  const std::vector<LabelColumns> labels(3, object_of({7, 7, 7, 7, 7}));
  const Solution joined = join_parts(model, labels, {second.view(), first.view()});
  GaussianCloud expected = model;
  expected.sh_rest[1 * 9 + 8] = -1, expected.position[3 * 3] = -2;
  CHECK(joined.cloud.sh_rest == expected.sh_rest);
  CHECK(joined.cloud.position == expected.position);
  CHECK(joined.source_row.empty());
  CHECK(joined.labels[0].prob == first.labels.prob);
  CHECK(joined.labels[1].label == second.labels.label);
  CHECK(joined.labels[2].prob == labels[2].prob);  // in no part
  CHECK(joined.figures.at("changed") == 2);
  CHECK(joined.figures.at("added") == 0);
}

TEST_CASE("Gaussians that parts halved come last, by object, whatever order the parts are given in") {
  const GaussianCloud model = cloud_of(4);
  // Part 0 halves row 1, part 1 row 3 twice over: 3 descendants.
  Part first(model, {0, 2, 3, 1, 1}, 0), second(model, {0, 1, 2, 3, 3, 3}, 1);
  const std::vector<LabelColumns> labels(2, object_of({0, 0, 0, 0}));
  const Solution joined = join_parts(model, labels, {second.view(), first.view()});
  CHECK(joined.source_row == RowList{0, 2, 1, 1, 3, 3, 3});
  CHECK(joined.cloud.size() == 7);
  CHECK(joined.cloud.logit_opacity == std::vector<float>{0, 0.25f, 0.125f, 0.125f, 0.375f, 0.375f, 0.375f});
  // Own rows as the part has them, rows that the other part added as their Gaussian.
  CHECK(joined.labels[0].prob == std::vector<float>{0, 1, 3, 4, 2, 2, 2});
  CHECK(joined.labels[1].prob == std::vector<float>{100, 102, 101, 101, 103, 104, 105});
  const Solution again = join_parts(model, labels, {first.view(), second.view()});
  CHECK(again.source_row == joined.source_row);
  CHECK(again.labels[1].prob == joined.labels[1].prob);
}

TEST_CASE("parts that contradict each other or the model are refused") {
  const GaussianCloud model = cloud_of(3);
  Part first(model, {0, 1, 2}, 0), second(model, {0, 1, 2}, 1);
  CHECK_FALSE(code_of(model, 2, {first.view(), second.view()}));  // nothing is wrong yet
  SUBCASE("both changed one Gaussian") {
    first.cloud.logit_opacity[2] = 9, second.cloud.sh_dc[6] = 9;
    CHECK(code_of(model, 2, {first.view(), second.view()}) == ErrorCode::kInconsistent);
  }
  SUBCASE("one halved what the other moved") {
    Part halved(model, {0, 1, 2, 2}, 0);
    second.cloud.position[8] = 9;
    CHECK(code_of(model, 2, {halved.view(), second.view()}) == ErrorCode::kInconsistent);
  }
  SUBCASE("both hold one object") {
    CHECK(code_of(model, 2, {first.view(), first.view()}) == ErrorCode::kInconsistent);
  }
  SUBCASE("a Gaussian of the model is lost") {
    CHECK(code_of(model, 1, {Part(model, {0, 2}, 0).view()}) == ErrorCode::kBadInput);
  }
  SUBCASE("a row descends from none of the model's") {
    first.source[1] = 3;
    CHECK(code_of(model, 2, {first.view()}) == ErrorCode::kBadInput);
    first.source[1] = -1;
    CHECK(code_of(model, 2, {first.view()}) == ErrorCode::kBadInput);
  }
  SUBCASE("the SH degree differs") {
    GaussianCloud other = model;
    other.resize(3, 0);
    const ModelPart part{"other", &other, &first.source, {0}, {first.labels}};
    CHECK(code_of(model, 1, {part}) == ErrorCode::kInconsistent);
  }
}

}  // namespace ngs
