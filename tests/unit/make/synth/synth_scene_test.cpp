#include "ngs/make/synth/synth_scene.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "ngs/core/error.h"
#include "ngs/core/rng.h"
#include "ngs/make/synth/synth_messy.h"
#include "ngs/make/synth/synth_render.h"

namespace ngs::synth {
namespace {

using V = Vec3<double>;

Camera plain_camera(int size) {
  Camera camera{"0.png", size, size, 1.5 * size, 1.5 * size, 0.5 * size + 0.3, 0.5 * size - 0.2, {}, {}};
  camera.rotation = {{1, 0, 0, 0, 0, -1, 0, 1, 0}};  // looks along +y, up is +z
  camera.translation = -1.0 * (camera.rotation * V{0, -4, 1});
  return camera;
}

AnalyticScene lone_sphere(V centre, double radius) {
  AnalyticScene scene;
  scene.objects = {{"ball", {sphere(centre, radius)}, {}}};
  scene.room = {{-6, -6, -6}, {6, 6, 6}, {}, {}};
  scene.light = normalized(scene.light);
  return scene;
}

std::vector<Solid> one_of_each() {
  const Mat3<double> turned = frame_with_z({0.3, -0.5, 0.8});
  return {sphere({0.1, 0.2, -0.1}, 0.4),
          box({0, 0.1, 0}, turned, {0.3, 0.5, 0.2}, 0.05),
          torus({0, 0, 0.1}, turned, 0.5, 0.1),
          capsule({-0.3, 0, 0}, {0.2, 0.4, 0.3}, 0.12),
          cylinder({0.1, 0, 0}, turned, 0.2, 0.45),
          blade({0, 0, 0}, turned, {0.6, 0.12, 0.02})};
}

}  // namespace

TEST_CASE("signed distances never overestimate and are exact along the normal") {
  for (const Solid& solid : one_of_each())
    for (std::uint64_t i = 0; i < 2000; ++i) {
      const auto draw = [&](std::uint64_t k) { return 2.4 * rng_uniform(i, RngStream::kTest, k) - 1.2; };
      const V p{draw(0), draw(1), draw(2)}, q{draw(3), draw(4), draw(5)};
      const double dp = signed_distance(solid, p), dq = signed_distance(solid, q);
      CHECK(std::abs(dp - dq) <= length(p - q) + 1e-12);  // 1-Lipschitz: sphere tracing cannot pass a surface
      if (dp > 0.01) {
        const V on = p - dp * surface_normal(solid, p);
        CHECK(std::abs(signed_distance(solid, on)) < 1e-4);  // the step of the normal's differences
      }
      if (dp < 0) CHECK(length(p - solid.centre) < solid.bound_radius + 1e-12);
    }
}

TEST_CASE("a cast shadow darkens the floor where an object hides the light, and nothing else") {
  AnalyticScene scene = lone_sphere({0, 0, 0}, 0.5);
  scene.room.low.z = -1;
  Camera camera = plain_camera(48);
  look_at(camera, {0, -4, 1}, {0, 0, -0.6});
  const SynthView lit = render_view({}, scene, camera, 1);
  scene.cast_shadows = true;
  const SynthView shaded = render_view({}, scene, camera, 1);
  int darker = 0, equal = 0;
  for (std::size_t i = 0; i < lit.label.data.size(); ++i) {
    const double ratio = double(shaded.colour.data[3 * i]) / double(lit.colour.data[3 * i]);
    REQUIRE(ratio <= 1 + 1e-6);
    darker += lit.label.data[i] == 0 && ratio < 0.6;
    equal += lit.label.data[i] == 0 && ratio > 0.999;
  }
  CHECK(darker > 20);
  CHECK(equal > 500);
}

TEST_CASE("a sphere's rendered silhouette has the area of the projected cone") {
  // The cone around a sphere seen at angle θ off-axis cuts the image in an ellipse; its solid outline is exact:
  // pixel centres inside the analytic cone, compared one by one, and the antialiased area against that count.
  const Camera camera = plain_camera(96);
  const V centre{0.3, 0.2, 0.7};
  const double radius = 0.8;
  const SynthView view = render_view({.threads = 2}, lone_sphere(centre, radius), camera, 8);
  const V to = centre - camera.centre();
  const double limit = std::sqrt(1 - radius * radius / dot(to, to));  // cosine of the cone's half angle
  int wrong = 0;
  double covered = 0, fine = 0;
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x) {
      const double cosine = dot(ray_direction(camera, x + 0.5, y + 0.5), normalized(to));
      if (std::abs(cosine - limit) > 1e-9) wrong += (cosine > limit) != (view.label.at(x, y) == 1);
      covered += double(view.coverage.at(x, y));
      for (int s = 0; s < 16 * 16; ++s) {
        const int row = s / 16;
        const V d = ray_direction(camera, x + (s % 16 + 0.5) / 16, y + (row + 0.5) / 16);
        fine += dot(d, normalized(to)) > limit;
      }
    }
  CHECK(wrong == 0);
  // Ellipse area: semi-axes from the cone's extent; π a b with a = f·sinθ'cosθ'/(cos²α - sin²θ'), b accordingly.
  const double sin2 = radius * radius / dot(to, to), forward = dot(to, {0, 1, 0}) / length(to), c2 = forward * forward;
  const double a = camera.fx * std::sqrt(sin2 * (1 - sin2)) / (c2 - sin2),
               b = camera.fx * std::sqrt(sin2 / (c2 - sin2));
  const double exact = 3.141592653589793 * a * b;
  CHECK(std::abs(fine / 256 - exact) < 0.5);  // the formula and the cone agree
  CHECK(std::abs(covered - exact) < 1.0);     // below a pixel of about 1300
}

TEST_CASE("depth at a pixel centre is the camera z of the analytic intersection") {
  const Camera camera = plain_camera(64);
  const V centre{0, 0, 1};
  const SynthView view = render_view({}, lone_sphere(centre, 0.7), camera, 1);
  for (int y = 20; y < 44; y += 3)
    for (int x = 20; x < 44; x += 3) {
      const V d = ray_direction(camera, x + 0.5, y + 0.5), to = centre - camera.centre();
      const double along = dot(to, d), under = along * along - dot(to, to) + 0.49;
      if (under < 0.01) continue;
      const double z = (along - std::sqrt(under)) * d.y;
      CHECK(double(view.depth.at(x, y)) == doctest::Approx(z).epsilon(1e-5));
    }
}

TEST_CASE("labels equal the object hit by a ray through the pixel centre, in every scene") {
  for (const auto& kind : kSceneNames) {
    Recipe recipe = named_recipe(std::string(kind.name));
    recipe.width_px = 40;
    recipe.height_px = 30;
    recipe.views = 3;
    recipe.samples_per_side = 1;
    const AnalyticScene scene = build_scene(recipe);
    const std::vector<Camera> rig = build_rig(recipe, scene);
    for (const Camera& camera : rig) {
      const SynthView view = render_view({.threads = 2}, scene, camera, 1);
      int wrong = 0;
      for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 40; ++x) {
          const Hit hit = trace(scene, camera.centre(), ray_direction(camera, x + 0.5, y + 0.5));
          wrong += label_of(scene, hit.object) != view.label.at(x, y);
          // One sample per pixel sits at the centre, so coverage is the target's mask.
          wrong += (view.label.at(x, y) == scene.target + 1) != (view.coverage.at(x, y) == 1.f);
        }
      CHECK(wrong == 0);
    }
  }
}

TEST_CASE("every scene shows its target in every view and a background everywhere else") {
  for (const Rig rig : {Rig::kOrbit, Rig::kForward})
    for (const auto& kind : kSceneNames) {
      Recipe recipe = named_recipe(std::string(kind.name));
      CAPTURE(kind.name);
      recipe.width_px = 80;
      recipe.height_px = 60;
      recipe.rig = rig;
      recipe.samples_per_side = 1;
      const AnalyticScene scene = build_scene(recipe);
      for (const Camera& camera : build_rig(recipe, scene)) {
        const SynthView view = render_view({.threads = 2}, scene, camera, 1);
        const int ground_id = kind.value == SceneKind::kGround ? 2 : 0;
        int target = 0, background = 0;
        for (const std::uint16_t id : view.label.data) {
          target += id == scene.target + 1;
          background += id == 0 || ground_id == id;
        }
        const bool is_crowded = kind.value == SceneKind::kTable || kind.value == SceneKind::kMessy;
        CHECK(target >= (is_crowded ? 0 : 40));
        CHECK(background > 400);
        int strange = 0;
        for (const float z : view.depth.data) strange += !std::isfinite(z);
        for (const float c : view.colour.data) strange += !(c > 0.f && c <= 1.f);
        CHECK(strange == 0);
      }
    }
}

/// Red of the object right of its mean column less that left of it.
double balance_of(const SynthView& view, std::uint16_t id) {
  double balance = 0, across = 0, pixels = 0;
  for (const bool sums : {false, true})
    for (int y = 0; y < view.label.height_px; ++y)
      for (int x = 0; x < view.label.width_px; ++x) {
        if (view.label.at(x, y) != id) continue;
        if (sums) {
          balance += (x < across / pixels ? -1 : 1) * double(view.colour.at(x, y, 0));
          continue;
        }
        across += x;
        pixels += 1;
      }
  return balance;
}

TEST_CASE("the light of the turntable stays with the camera: the same side of the bust is bright in every photo") {
  for (const std::string name : {"turntable", "ground"}) {
    Recipe recipe = named_recipe(name);
    recipe.width_px = 80;
    recipe.height_px = 60;
    recipe.views = 8;
    recipe.principal_shift = 0;
    const AnalyticScene scene = build_scene(recipe);
    int right = 0;
    for (const Camera& camera : build_rig(recipe, scene))
      right += balance_of(render_view({.threads = 2}, scene, camera, 2), std::uint16_t(scene.target + 1)) > 0;
    CAPTURE(name);
    CHECK((right == 0 || right == 8) == scene.turns);
  }
}

TEST_CASE("the table scene holds at least twenty objects with distinct names") {
  const AnalyticScene scene = build_scene(named_recipe("table"));
  std::set<std::string> names;
  for (const Object& object : scene.objects) names.insert(object.name);
  CHECK(names.size() == scene.objects.size());
  CHECK(names.size() >= 20);
}

TEST_CASE("the two spheres touch and do not overlap") {
  const AnalyticScene scene = build_scene(named_recipe("two-spheres"));
  const Solid &a = scene.objects[0].solids[0], &b = scene.objects[1].solids[0];
  CHECK(length(a.centre - b.centre) == doctest::Approx(a.size.x + b.size.x).epsilon(1e-12));
}

TEST_CASE("the rig has orthonormal cameras with off-centre principal points in every third view") {
  Recipe recipe = named_recipe("tiny");
  recipe.mixed_sizes = true;
  const std::vector<Camera> rig = build_rig(recipe, build_scene(recipe));
  REQUIRE(rig.size() == 6);
  for (std::size_t i = 0; i < rig.size(); ++i) {
    const Mat3<double> identity = rig[i].rotation * transpose(rig[i].rotation);
    for (int k = 0; k < 9; ++k) CHECK(identity.m[k] == doctest::Approx(k % 4 == 0 ? 1.0 : 0.0));
    CHECK((rig[i].cx != rig[i].width_px / 2.0) == (i % 3 == 1));
    CHECK((rig[i].width_px != 64) == (i % 4 == 1));
  }
  CHECK(rig[3].name == "0003.png");
}

TEST_CASE("a grey scene has the luminance of the coloured one, and its masks") {
  Recipe recipe = named_recipe("tiny");
  const AnalyticScene coloured = build_scene(recipe);
  recipe.grey = true;
  const Camera camera = build_rig(recipe, coloured)[0];
  const SynthView a = render_view({}, coloured, camera, 1), b = render_view({}, build_scene(recipe), camera, 1);
  CHECK(a.label.data == b.label.data);
  double chroma = 0;
  for (int y = 0; y < camera.height_px; ++y)
    for (int x = 0; x < camera.width_px; ++x) {
      const float red = a.colour.at(x, y, 0), green = a.colour.at(x, y, 1), blue = a.colour.at(x, y, 2);
      CHECK(b.colour.at(x, y, 1) == doctest::Approx(0.299 * red + 0.587 * green + 0.114 * blue).epsilon(1e-6));
      CHECK(b.colour.at(x, y, 0) == b.colour.at(x, y, 2));
      chroma = std::max(chroma, double(std::abs(red - blue)));
    }
  CHECK(chroma > 0.2);  // the coloured scene has colour
}

TEST_CASE("an unknown recipe or target is a usage error that lists what exists") {
  CHECK_THROWS_WITH_AS(named_recipe("cube"), doctest::Contains("two-spheres, torus-box"), Error);
  Recipe recipe = named_recipe("tiny");
  recipe.target = "cube";
  CHECK_THROWS_WITH_AS(build_scene(recipe), doctest::Contains("large, small"), Error);
}

TEST_CASE("rendering is bit-identical for any thread count and sparse points lie on surfaces") {
  const Recipe recipe = named_recipe("tiny");
  const AnalyticScene scene = build_scene(recipe);
  const std::vector<Camera> rig = build_rig(recipe, scene);
  std::vector<SynthView> views;
  for (const Camera& camera : rig) views.push_back(render_view({.threads = 2}, scene, camera, 2));
  CHECK(render_view({.threads = 1}, scene, rig[1], 2).colour.data == views[1].colour.data);
  const std::vector<SparsePoint> points = sample_points(rig, views, 300, 1);
  int tracked = 0;
  for (const SparsePoint& point : points) {
    double nearest = std::min({point.position.z - scene.room.low.z, scene.room.high.z - point.position.z,
                               point.position.x - scene.room.low.x, scene.room.high.x - point.position.x,
                               point.position.y - scene.room.low.y, scene.room.high.y - point.position.y});
    for (const Object& object : scene.objects)
      for (const Solid& solid : object.solids) nearest = std::min(nearest, signed_distance(solid, point.position));
    CHECK(std::abs(nearest) < 5 * 0.3 * 7 / rig[0].fx);  // five sigma of 0.3 px at the farthest wall
    tracked += point.track.size() >= 2;
  }
  CHECK(tracked > 200);
}

namespace {

using V = Vec3<double>;

AnalyticScene room_of(int objects, std::int64_t seed = 1) {
  Recipe recipe = named_recipe("messy");
  recipe.objects = objects;
  recipe.scene_seed = seed;
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
  recipe.objects = 300;
  recipe.views = 12;
  recipe.width_px = 200;
  recipe.height_px = 150;
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
