#include "ngs/make/synth/synth_messy.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "ngs/core/rng.h"
#include "ngs/make/synth/synth_render.h"
#include "ngs/make/synth/synth_scene.h"

namespace ngs::synth {
namespace {

using V = Vec3<double>;

AnalyticScene room_of(int objects, std::int64_t seed = 1) {
  Recipe recipe = named_recipe("messy");
  recipe.objects = objects, recipe.scene_seed = seed;
  return build_scene(recipe);
}

/// The deepest of many random points of solid `a` inside of `b`, world units; negative: the least distance found.
double depth_of_overlap(const Solid& a, const Solid& b) {
  if (length(a.centre - b.centre) > a.bound_radius + b.bound_radius) return -1;
  double deepest = -1;
  for (std::uint64_t i = 0; i < 400; ++i) {
    const auto draw = [&](std::uint64_t k) { return a.bound_radius * (2 * rng_uniform(i, RngStream::kTest, k) - 1); };
    V p = a.centre + V{draw(0), draw(1), draw(2)};
    if (signed_distance(a, p) > 0) p = p - signed_distance(a, p) * surface_normal(a, p);
    deepest = std::max(deepest, std::min(-signed_distance(b, p), 1e-6 - signed_distance(a, p)));
  }
  return deepest;
}

}  // namespace

TEST_CASE("a messy room has the asked number of objects, with unique names, before its furniture") {
  for (const int count : {1, 2, 25, 300}) {
    CAPTURE(count);
    const AnalyticScene scene = room_of(count);
    CHECK(object_count(scene) == std::size_t(count));
    REQUIRE(scene.objects.size() == std::size_t(count) + 2);
    std::set<std::string> names;
    for (const Object& object : scene.objects) names.insert(object.name);
    CHECK(names.size() == scene.objects.size());
    CHECK(label_of(scene, count - 1) == count);
    CHECK(label_of(scene, count) == 0);
    CHECK(label_of(scene, count + 1) == 0);
    CHECK(label_of(scene, -1) == 0);
  }
}

TEST_CASE("no two objects of a messy room overlap, many touch, and none is in its furniture or the floor") {
  for (const std::int64_t seed : {1, 2}) {
    const AnalyticScene scene = room_of(60, seed);
    int touching = 0, in_others = 0, below = 0;
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
      for (const Solid& s : scene.objects[i].solids) below += s.centre.z < 0;
      for (std::size_t k = 0; k < scene.objects.size(); ++k) {
        if (i == k) continue;
        double deepest = -1;
        for (const Solid& a : scene.objects[i].solids)
          for (const Solid& b : scene.objects[k].solids) deepest = std::max(deepest, depth_of_overlap(a, b));
        in_others += deepest > 1e-4;
        touching += k < 60 && i < 60 && deepest > -5e-3;
      }
    }
    CHECK(in_others == 0);
    CHECK(touching > 30);
    CHECK(below == 0);
  }
}

TEST_CASE("a messy room shows every object in some view, furniture as background, and ids beyond 255") {
  Recipe recipe = named_recipe("messy");
  recipe.objects = 300, recipe.views = 12, recipe.width_px = 200, recipe.height_px = 150;
  const AnalyticScene scene = build_scene(recipe);
  std::set<std::uint16_t> ids;
  int furniture = 0;
  for (const Camera& camera : build_rig(recipe, scene)) {
    const SynthView view = render_view({.threads = 2}, scene, camera, 1);
    CHECK(render_view({.threads = 1}, scene, camera, 1).label.data == view.label.data);
    ids.insert(view.label.data.begin(), view.label.data.end());
    int other = 0, sides = 0;
    for (std::size_t p = 0; p < view.label.data.size(); ++p) {
      const std::uint16_t id = view.label.data[p], surface = view.surface.data[p];
      other += id > 0 ? surface != id : surface <= 300 || surface > 302 + 6;
      sides += surface > 302;
    }
    CHECK(other == 0);
    CHECK(sides > 1000);
    for (int x = 2; x < 200; x += 5) {
      const Hit hit = trace(scene, camera.centre(), ray_direction(camera, x + 0.5, 75.5));
      furniture += hit.object >= 300 && view.label.at(x, 75) == 0;
    }
  }
  CHECK(ids.size() > 270);
  CHECK(*ids.rbegin() > 255);
  CHECK(*ids.rbegin() <= 300);
  CHECK(furniture > 50);
}

}  // namespace ngs::synth
