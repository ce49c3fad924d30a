#include "ngs/cut/passes/components/components.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "support/changed_labels.h"
#include "support/joint_case.h"

namespace ngs {
namespace {

constexpr float kViews = 16;  // views of the ball's Gaussians; the ball has radius 0.6 about (0, 0, 4)

/// The ball has certain labels, the wall has none; rows of the wall can be moved and labelled.
struct ComponentCase {
  std::unique_ptr<test::JointCase> base = test::joint_case();
  std::vector<float> fixed;

  ComponentCase() {
    LabelColumns& ball = base->labels[0];
    for (std::size_t i = 0; i < base->is_ball.size(); ++i) {
      ball.label[i] = ball.prob[i] = base->is_ball[i];
      ball.views[i] = kViews;
    }
  }
  void claim(std::size_t row, float x, float z, float prob, float views) {
    base->model.position[3 * row] = x;
    base->model.position[3 * row + 1] = 0;
    base->model.position[3 * row + 2] = z;
    base->labels[0].prob[row] = prob;
    base->labels[0].label[row] = prob > 0.5f;
    base->labels[0].views[row] = views;
  }
  ComponentFinding find() const {
    Problem in = base->input();
    in.fixed = fixed;
    ComponentFinding found = find_disconnected({}, in, in.labels);
    CHECK(count_disconnected({}, in) == found.count);
    return found;
  }
};

}  // namespace

TEST_CASE("the core and disconnected components are found although most views do not see the object") {
  ComponentCase c;
  LabelColumns& ball = c.base->labels[0];
  for (std::size_t i = 0; i < c.base->is_ball.size(); ++i)
    if (c.base->is_ball[i] == 0) ball.views[i] = 10 * kViews;  // the wall
  c.claim(200, 0, 9, 1, 1);
  for (const double seen : {0.25, 0.5, 1.0}) {
    const ObjectCore core = core_of({.seen = seen}, c.base->model, c.base->labels);
    CHECK(core.min_views == seen * kViews);
    CHECK(core.count == std::count(c.base->is_ball.begin(), c.base->is_ball.end(), 1.f));
  }
  CHECK(c.find().disconnected[200] == 1);
}

TEST_CASE("a disconnected piece that few views label as object is treated as unseen, and nothing else changes") {
  ComponentCase c;
  c.claim(200, 0, 9, 1, 1);
  const ComponentFinding found = c.find();
  CHECK(found.count == 1);
  CHECK(std::count(found.disconnected.begin(), found.disconnected.end(), 1) == 1);
  CHECK(found.disconnected[200] == 1);
  for (const auto column : kLabelColumns) {
    LabelColumn want = c.base->labels[0].*column;
    want[200] = 0;
    CHECK(found.labels[0].*column == want);
  }
}

TEST_CASE("a piece that a third of the views sees unoccluded is not part of the core") {
  ComponentCase c;
  for (std::size_t i = 200; i < 210; ++i) c.claim(i, 0, 9, 1, 6);
  c.claim(210, 0.1f, 9, 1, 1);
  CHECK(c.find().count == 11);
}

TEST_CASE("Gaussians connected to the ball keep their labels at any distance, Gaussians beyond a gap do not") {
  const auto with_arm = [](float prob) {  // out to 7 radii
    ComponentCase c;
    for (std::size_t i = 0; i < 20; ++i) c.claim(200 + i, 0.6f + 0.2f * float(i), 4, prob, 1);
    return c;
  };
  ComponentCase whole = with_arm(1), cut = with_arm(1), faint = with_arm(0.3f);
  CHECK(whole.find().count == 0);
  for (std::size_t i = 204; i < 212; ++i) cut.claim(i, 0.6f, 4, 1, 1);
  CHECK(cut.find().count == 8);
  CHECK(faint.find().count > 8);  // shares below a half do not link
}

TEST_CASE("pieces that many views see, near, barely labelled, unusable or fixed pieces are not removed") {
  ComponentCase c;
  c.claim(200, 0, 9, 0.7f, kViews / 2);  // not in the core, but seen by many views
  c.claim(201, 0.7f, 4, 1, 1);
  c.claim(202, 0, 9, 0.04f, 1);
  c.claim(203, NAN, 9, 1, 1);
  c.base->model.usable[203] = 0;
  c.claim(204, 0, 9, 1, 1);
  c.fixed.assign(c.base->is_ball.size(), 0);
  c.fixed[204] = 1;
  CHECK(c.find().count == 0);
  c.claim(205, 3e38f, -3e38f, 1, 1);  // outside all cells, and still disconnected
  CHECK(c.find().count == 1);
}

TEST_CASE("without a core, or with so few views that one is half of them, no piece is removed") {
  ComponentCase c;
  c.claim(200, 0, 9, 1, 1);
  ComponentCase few = std::move(c), none;
  test::change(few.base->labels[0].views, [](float v) { return std::min(v, 2.f); });
  CHECK(few.find().count == 0);
  test::change(few.base->labels[0].views, [](float v) { return 2 * v; });
  few.base->labels[0].views[200] = 1;
  CHECK(few.find().count == 1);
  test::change(none.base->labels[0].prob, [](float p) { return 0.8f * p; });
  none.claim(200, 0, 9, 0.8f, 1);
  CHECK(none.find().count == 0);
}

TEST_CASE("a piece that is disconnected from one object and part of another keeps the other's label") {
  ComponentCase c;
  c.base->scene.objects.push_back({"room", 1});
  c.base->labels.push_back(c.base->labels[0]);
  LabelColumns& room = c.base->labels[1];
  for (std::size_t i = 0; i < c.base->is_ball.size(); ++i) room.prob[i] = room.label[i] = 1 - c.base->is_ball[i];
  c.claim(200, 0, 5.7f, 1, 1);
  const ComponentFinding found = c.find();
  CHECK(found.count == 1);
  CHECK(found.labels[0].prob[200] == 0);
  CHECK(found.labels[1].prob[200] == 1);
  CHECK(std::count(found.disconnected.begin(), found.disconnected.end(), 1) == 0);
}

TEST_CASE("a label trained on a disconnected Gaussian is restored, one next to the object stays") {
  ComponentCase c;
  c.claim(200, 0, 9, 0.2f, kViews);
  c.claim(201, 0, 3.3f, 0.2f, kViews);
  c.claim(202, 0, 9, 0.8f, kViews);
  const Problem input = c.base->input();
  Solution trained{.cloud = unchanged(c.base->model), .labels = std::vector<LabelColumns>(input.labels)};
  for (const std::size_t row : {200, 201}) trained.labels[0].prob[row] = trained.labels[0].label[row] = 0.6f;
  CHECK(restore_disconnected_labels({}, input, trained) == 1);
  CHECK(trained.labels[0].prob[200] == 0.2f);
  CHECK(trained.labels[0].label[200] == 0.f);
  CHECK(trained.labels[0].prob[201] == 0.6f);
  CHECK(trained.labels[0].prob[202] == 0.8f);  // labelled by the evidence too
}

TEST_CASE("halves get their parent's label back, rows fixed by hand do not change") {
  ComponentCase c;
  c.claim(200, 0, 9, 0.2f, kViews);
  Problem input = c.base->input();
  Solution trained{.cloud = unchanged(c.base->model), .labels = std::vector<LabelColumns>(input.labels)};
  for (std::size_t i = 0; i < std::size_t(trained.cloud->size()); ++i) trained.source_row.push_back(std::int64_t(i));
  std::swap(trained.source_row[200], trained.source_row[203]);
  trained.labels[0].prob[200] = 0.6f;
  CHECK(restore_disconnected_labels({}, input, trained) == 1);
  CHECK(trained.labels[0].prob[200] == input.labels[0].prob[203]);
  trained.labels[0].prob[200] = 0.6f;
  input.fixed.assign(input.labels[0].prob.size(), 1.f);
  CHECK(restore_disconnected_labels({}, input, trained) == 0);
}

}  // namespace ngs
