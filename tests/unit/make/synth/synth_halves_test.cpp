#include "ngs/make/synth/synth_halves.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "ngs/core/error.h"
#include "ngs/make/synth/synth_render.h"

namespace ngs::synth {
namespace {

using V = Vec3<double>;

struct SmallScene {
  Recipe recipe;
  AnalyticScene scene;
  std::vector<Camera> rig;
};

SmallScene small_scene(const std::string& name, int views = 4) {
  SmallScene small;
  small.recipe = named_recipe(name);
  small.recipe.width_px = 80;
  small.recipe.height_px = 60;
  small.recipe.views = views;
  small.scene = build_scene(small.recipe);
  small.rig = build_rig(small.recipe, small.scene);
  return small;
}

/// The world point that a view shows at the centre of a pixel.
V point_at(const SynthView& view, const Camera& camera, int x, int y) {
  const V d = ray_direction(camera, x + 0.5, y + 0.5);
  const V forward{camera.rotation(2, 0), camera.rotation(2, 1), camera.rotation(2, 2)};
  return camera.centre() + (double(view.depth.at(x, y)) / dot(d, forward)) * d;
}

double distance_to_target(const AnalyticScene& scene, V p) {
  double nearest = INFINITY;
  for (const Solid& s : scene.objects[std::size_t(scene.target)].solids)
    nearest = std::min(nearest, signed_distance(s, p));
  return nearest;
}

/// Up to the tolerance at which rays hit: without an object in their way they take other steps to the same surface.
bool same_colour(const SynthView& a, const SynthView& b, int x, int y) {
  float difference = 0;
  for (int c = 0; c < 3; ++c) difference = std::max(difference, std::abs(a.colour.at(x, y, c) - b.colour.at(x, y, c)));
  return difference < 1e-4f;
}

}  // namespace

TEST_CASE("the target alone covers the pixels of the photos that show it, and beyond these only pixels of occluders") {
  int occluded = 0;
  for (const char* name : {"torus-box", "two-spheres", "leaves"}) {
    CAPTURE(name);
    const SmallScene small = small_scene(name);
    for (const Camera& camera : small.rig) {
      const SynthView full = render_view({}, small.scene, camera, 1),
                      alone = render_view({}, target_alone(small.scene), camera, 1);
      int wrong = 0;
      for (std::size_t i = 0; i < full.label.data.size(); ++i) {
        const bool in_photo = full.coverage.data[i] == 1.f, by_itself = alone.coverage.data[i] == 1.f;
        wrong += in_photo && !by_itself;
        wrong += by_itself && full.label.data[i] == 0;  // the room is behind the target
        occluded += by_itself && !in_photo;
      }
      CHECK(wrong == 0);
    }
  }
  CHECK(occluded > 100);
}

TEST_CASE("the target alone has the photos' colours where it fills a pixel, and is black where it is absent") {
  const SmallScene small = small_scene("torus-box");
  int filled = 0;
  for (const Camera& camera : small.rig) {
    const SynthView full = render_view({}, small.scene, camera, 3),
                    alone = render_view({}, target_alone(small.scene), camera, 3);
    int wrong = 0;
    for (int y = 0; y < camera.height_px; ++y)
      for (int x = 0; x < camera.width_px; ++x) {
        if (full.coverage.at(x, y) > 0.999f) {
          ++filled;
          wrong += !same_colour(full, alone, x, y);
        }
        if (alone.coverage.at(x, y) == 0.f) wrong += alone.colour.at(x, y, 0) != 0.f;
      }
    CHECK(wrong == 0);
  }
  CHECK(filled > 400);
}

TEST_CASE("the room without the target equals the photo where it neither covers nor shades, and nowhere in the hole") {
  const SmallScene small = small_scene("torus-box");
  int equal = 0, shaded = 0;
  for (const Camera& camera : small.rig) {
    const SynthView full = render_view({.threads = 2}, small.scene, camera, 1);
    const SynthView room = render_view({.threads = 2}, without_target(small.scene), camera, 1);
    int wrong = 0, hole = 0, unchanged = 0;
    for (int y = 0; y < camera.height_px; ++y)
      for (int x = 0; x < camera.width_px; ++x) {
        wrong += room.label.at(x, y) == small.scene.target + 1;
        const bool same = same_colour(full, room, x, y), shows = full.label.at(x, y) == small.scene.target + 1;
        if (shows) {
          ++hole;
          unchanged += same;
        }
        if (shows) continue;
        // Contact shadows reach 0.15 from a point that is 0.15 above the surface.
        const bool reached = distance_to_target(small.scene, point_at(room, camera, x, y)) < 0.31;
        if (!reached) {
          ++equal;
          wrong += !same;
        }
        shaded += reached && !same;
      }
    CHECK(wrong == 0);
    CHECK(hole > 100);
    CHECK(unchanged == 0);
    CHECK(render_view({.threads = 1}, without_target(small.scene), camera, 1).colour.data == room.colour.data);
  }
  CHECK(equal > 4000);
  CHECK(shaded > 20);
}

TEST_CASE(
    "the directions of the target alone are even, include both poles, and show the whole target, in every scene") {
  for (const auto& kind : kSceneNames) {
    CAPTURE(kind.name);
    const SmallScene small = small_scene(std::string(kind.name), 1);
    const V centre = target_ball(small.scene).centre;
    const std::vector<Camera> rig = target_rig(small.recipe, small.scene);
    REQUIRE(rig.size() == kTargetViews);
    double lowest = 1, highest = -1, nearest = INFINITY;
    int cut_off = 0, empty = 0;
    for (const Camera& camera : rig) {
      const V out = normalized(camera.centre() - centre);
      lowest = std::min(lowest, out.z);
      highest = std::max(highest, out.z);
      for (const Camera& other : rig)
        if (other.name != camera.name) nearest = std::min(nearest, length(normalized(other.centre() - centre) - out));
      const SynthView view = render_view({.threads = 2}, target_alone(small.scene), camera, 1);
      for (int x = 0; x < 80; ++x) cut_off += view.label.at(x, 0) != 0 || view.label.at(x, 59) != 0;
      for (int y = 0; y < 60; ++y) cut_off += view.label.at(0, y) != 0 || view.label.at(79, y) != 0;
      empty += *std::max_element(view.label.data.begin(), view.label.data.end()) == 0;
    }
    CHECK(cut_off == 0);
    CHECK(empty == 0);
    CHECK(lowest < -0.98);
    CHECK(highest > 0.98);
    CHECK(nearest > 0.3);  // 64 discs of this diameter cover 0.36 of the sphere
  }
}

TEST_CASE("24 more cameras of every scene stand clear of solids and walls, and most of them see the hole") {
  for (const auto& kind : kSceneNames) {
    CAPTURE(kind.name);
    const SmallScene small = small_scene(std::string(kind.name), 1);
    const std::vector<Camera> rig = hole_rig(small.recipe, small.scene);
    REQUIRE(rig.size() == 2 * kHoleViews);
    CHECK(rig.front().name == "above-00.png");
    CHECK(rig.back().name == "near-11.png");
    std::set<std::string> names;
    int blocked = 0, see_hole = 0;
    for (const Camera& camera : rig) {
      names.insert(camera.name);
      const V p = camera.centre(), a = p - small.scene.room.low, b = small.scene.room.high - p;
      blocked += std::min({a.x, a.y, a.z, b.x, b.y, b.z}) < 0.3;
      for (const Object& object : small.scene.objects)
        for (const Solid& solid : object.solids) blocked += signed_distance(solid, p) < 0.3;
      const SynthView view = render_view({.threads = 2}, small.scene, camera, 1);
      see_hole += std::count(view.label.data.begin(), view.label.data.end(), small.scene.target + 1) > 4;
    }
    CHECK(names.size() == rig.size());
    CHECK(blocked == 0);
    CHECK(see_hole >= 20);
  }
}

TEST_CASE("floor and both walls lie behind the target of the corner") {
  const SmallScene small = small_scene("corner", 1);
  const SynthView full = render_view({}, small.scene, small.rig[0], 1),
                  room = render_view({}, without_target(small.scene), small.rig[0], 1);
  int floor = 0, wall_x = 0, wall_y = 0;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 80; ++x) {
      if (full.label.at(x, y) != small.scene.target + 1) continue;
      const V p = point_at(room, small.rig[0], x, y) - small.scene.room.low;
      floor += std::abs(p.z) < 1e-4;
      wall_x += std::abs(p.x) < 1e-4;
      wall_y += std::abs(p.y) < 1e-4;
    }
  CHECK(floor > 20);
  CHECK(wall_x > 20);
  CHECK(wall_y > 20);
}

TEST_CASE("a target that leaves no place for cameras around it is a usage error") {
  SmallScene small = small_scene("ground", 1);
  small.scene.target = 1;
  CHECK_THROWS_WITH_AS(hole_rig(small.recipe, small.scene),
                       doctest::Contains("\"ground\" has 0 places for cameras above"), Error);
}

}  // namespace ngs::synth
