#include "ngs/problem/problem.h"

#include <doctest/doctest.h>

#include "support/joint_case.h"

namespace ngs {
namespace {

/// A problem with a value in every optional member.
Problem full(const test::JointCase& c, Monitor& monitor) {
  Problem problem = c.input();
  const auto n = std::size_t(c.model.size());
  problem.rule = {.tau = 0.3, .criterion = Criterion::kBetweenViews};
  problem.background = {0.1f, 0.2f, 0.3f}, problem.seed = 7;
  problem.fixed.assign(n, 1.f), problem.frozen.assign(n, 1), problem.region.assign(n, 1);
  problem.weight = std::make_shared<const std::vector<float>>(n, 2.f);
  problem.load_fine_photo = problem.load_photo;
  problem.window_share.assign(c.scene.views.size(), 0.5);
  problem.uncropped = std::make_shared<const Problem>(c.input());
  problem.owns.push_back(std::make_shared<int>(1));
  problem.monitor = &monitor;
  return problem;
}

void check_rest(const Problem& next, const Problem& from) {
  CHECK(next.views == from.views);
  CHECK(next.background.y == from.background.y);
  CHECK(next.seed == from.seed);
  CHECK(next.fixed == from.fixed);
  CHECK(next.rule == from.rule);
  CHECK(next.frozen == from.frozen);
  CHECK(next.region == from.region);
  CHECK(bool(next.load_fine_photo));
  CHECK(next.uncropped == from.uncropped);
  CHECK(next.monitor == from.monitor);
}

}  // namespace

TEST_CASE("problem: with_model() replaces model and labels, clears the weight, and keeps all other members") {
  const auto c = test::joint_case();
  Monitor monitor;
  const Problem from = full(*c, monitor);
  std::weak_ptr<const GaussianCloud> model;
  {
    auto other = std::make_shared<const GaussianCloud>(c->model);
    model = other;
    const Problem next = from.with_model(std::move(other), {LabelColumns{}});
    CHECK(&next.cloud == model.lock().get());
    CHECK(&next.scene == &from.scene);
    CHECK(next.labels.size() == 1);
    CHECK(next.weight == nullptr);
    CHECK(next.window_share == from.window_share);
    CHECK(next.owns.size() == 2);
    check_rest(next, from);
  }
  CHECK(model.expired());  // only the problem owned it
}

TEST_CASE("problem: with_views() replaces cameras and loaders; cropped() also clears the weight") {
  const auto c = test::joint_case();
  Monitor monitor;
  const Problem from = full(*c, monitor);
  const Scene scene = c->scene;
  const auto masks = [](std::size_t) { return ViewMasks{3, 2, {}, {}, true}; };
  const auto photo = [](std::size_t) { return ImageF(3, 2, 3); };
  const Problem seen = from.with_views(scene, masks, photo), part = from.cropped(scene, masks, photo, {0.25});
  for (const Problem* next : {&seen, &part}) {
    CHECK(&next->cloud == &from.cloud);
    CHECK(&next->scene == &scene);
    CHECK(next->load_masks(0).width_px == 3);
    CHECK(next->load_photo(0).width_px == 3);
    check_rest(*next, from);
  }
  CHECK(seen.weight == from.weight);
  CHECK(seen.window_share == from.window_share);
  CHECK(part.weight == nullptr);
  CHECK(part.window_share == std::vector<double>{0.25});
}

}  // namespace ngs
