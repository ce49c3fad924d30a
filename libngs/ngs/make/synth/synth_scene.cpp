#include "ngs/make/synth/synth_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ngs/core/error.h"
#include "ngs/make/synth/synth_dice.h"
#include "ngs/make/synth/synth_messy.h"

namespace ngs::synth {
namespace {

constexpr double kPi = std::numbers::pi;
using V = Vec3<double>;

void two_spheres(AnalyticScene& scene) {
  const double a = 0.55, b = 0.42;  // in contact: the centres are a + b apart
  const double level = std::sqrt((a + b) * (a + b) - (a - b) * (a - b)), angle = 0.45;
  const V first{-0.45, 0, a}, second{first.x + level * std::cos(angle), level * std::sin(angle), b};
  scene.objects = {
      {"large", {sphere(first, a)}, {Pattern::kMarble, {0.85, 0.35, 0.2}, {0.95, 0.8, 0.45}, 1.6, 0.12, 1}},
      {"small", {sphere(second, b)}, {Pattern::kStripes, {0.15, 0.35, 0.6}, {0.75, 0.85, 0.9}, 2.2, 0.1, 2}}};
  scene.focus = {0, 0.1, 0.42};
  scene.rig_radius = 2.6;
}

void torus_box(AnalyticScene& scene) {
  const Solid ring = torus({0.28, 0, 0.66}, frame_with_z({0.25, 1, 0.15}), 0.46, 0.12);
  scene.objects = {{"torus", {ring}, {Pattern::kStripes, {0.8, 0.25, 0.3}, {0.95, 0.75, 0.3}, 2.5, 0.1, 3}},
                   {"box",
                    {box({-0.2, 0, 0.42}, turned_about_z(0.5), {0.4, 0.3, 0.42}, 0.03)},
                    {Pattern::kChecker, {0.2, 0.45, 0.4}, {0.75, 0.8, 0.65}, 4, 0.1, 4}}};
  scene.focus = {0.05, 0, 0.5};
  scene.rig_radius = 2.6;
}

/// One frond: a bent stem with pairs of pointed leaflets that shrink towards the tip.
void add_frond(Object& object, V root, double azimuth, double reach, int pairs) {
  const V out{std::cos(azimuth), std::sin(azimuth), 0}, vertical{0, 0, 1};
  const auto stem = [&](double t) { return root + (reach * t) * out + (reach * (0.95 * t - 0.75 * t * t)) * vertical; };
  for (int i = 0; i < pairs; ++i) {
    const double t0 = double(i) / pairs, t1 = double(i + 1) / pairs;
    object.solids.push_back(capsule(stem(t0), stem(t1), 0.016 * (1.2 - t0)));
    if (i == 0) continue;
    const V along = normalized(stem(t1) - stem(t0)), side = normalized(cross(vertical, along));
    const double half = 0.5 * reach * 0.42 * std::sin(kPi * (0.15 + 0.8 * t0));
    for (const double sign : {-1.0, 1.0}) {
      const V x = normalized(sign * side + 0.55 * along + (-0.2) * vertical), y = normalized(cross(vertical, x));
      const V z = cross(x, y);
      object.solids.push_back(blade(stem(t0) + half * x, {{x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z}},
                                    {half, 0.16 * half + 0.012, 0.006}));
    }
  }
}

void leaves(AnalyticScene& scene, Dice& dice) {
  Object fern{"fern", {}, {Pattern::kMarble, {0.2, 0.5, 0.15}, {0.55, 0.75, 0.25}, 3, 0.1, 5}};
  for (int i = 0; i < 7; ++i) {
    const double azimuth = 2 * kPi * i / 7 + dice.uniform(-0.2, 0.2), reach = dice.uniform(0.7, 0.95);
    add_frond(fern, {0, 0, 0.34}, azimuth, reach, 8);
  }
  Object pot{"pot",
             {cylinder({0, 0, 0.17}, kUpright, 0.24, 0.17)},
             {Pattern::kSpots, {0.7, 0.35, 0.22}, {0.85, 0.55, 0.4}, 4, 0.1, 6}};
  scene.objects = {fern, pot};
  scene.focus = {0, 0, 0.42};
  scene.rig_radius = 2.5;
}

void bones(AnalyticScene& scene) {
  Object skeleton{"skeleton", {}, {Pattern::kSpots, {0.9, 0.85, 0.7}, {0.7, 0.6, 0.42}, 6, 0.12, 7}};
  const auto spine = [](double t) {
    return V{1.3 * (t - 0.5), 0.1 * std::sin(3 * t), 0.62 + 0.12 * std::sin(kPi * t)};
  };
  for (int i = 0; i < 10; ++i) skeleton.solids.push_back(capsule(spine(i / 10.0), spine((i + 1) / 10.0), 0.035));
  for (int i = 1; i < 10; ++i)
    for (const double side : {-1.0, 1.0}) {
      const V top = spine(i / 10.0);
      const double width = 0.34 * std::sin(kPi * i / 10.0) + 0.05;
      const V elbow = top + V{0.03, side * width, -0.12}, tip = top + V{0.1, side * 0.5 * width, -0.45};
      skeleton.solids.push_back(capsule(top, elbow, 0.02));
      skeleton.solids.push_back(capsule(elbow, tip, 0.016));
    }
  skeleton.solids.push_back(sphere(spine(1) + V{0.1, 0, 0.02}, 0.15));
  Object rods{"rods", {}, {Pattern::kStripes, {0.25, 0.3, 0.55}, {0.6, 0.7, 0.85}, 4, 0.08, 8}};
  for (int i = 0; i < 5; ++i) {
    const double x = -0.5 + 0.24 * i;
    rods.solids.push_back(capsule({x, -0.55, 0.02}, {x + 0.18, 0.5, 0.75}, 0.02));
  }
  scene.objects = {skeleton, rods};
  scene.focus = {0, 0, 0.45};
  scene.rig_radius = 2.4;
}

/// Item k on the table: one of four shapes, at (x, y, 0).
Object table_item(int k, double x, double y, Dice& dice) {
  const double r = dice.uniform(0.09, 0.125), turn = dice.uniform(0, kPi);
  Object item{"item" + std::to_string(k), {}, {}};
  switch (k % 4) {
    case 0: item.solids = {sphere({x, y, r}, r)}; break;
    case 1: item.solids = {box({x, y, 1.1 * r}, turned_about_z(turn), {0.8 * r, r, 1.1 * r}, 0.012)}; break;
    case 2: item.solids = {cylinder({x, y, 1.4 * r}, kUpright, 0.75 * r, 1.4 * r)}; break;
    default: item.solids = {torus({x, y, 0.035}, kUpright, r, 0.035)}; break;
  }
  const V a = bright(dice), b{1.25 - a.x, 1.25 - a.y, 1.25 - a.z};
  item.texture = {Pattern(k % 3), a, b, dice.uniform(3, 5), 0.1, std::uint32_t(40 + k)};
  return item;
}

void table(AnalyticScene& scene, Dice& dice) {
  scene.objects.clear();
  for (int k = 0; k < 24; ++k) {  // a jittered 6 x 4 grid: neighbours come close, none overlap
    const int column = k % 6, row = k / 6;
    const double x = -0.8 + 0.32 * column + dice.uniform(-0.025, 0.025);
    const double y = -0.5 + 0.333 * row + dice.uniform(-0.03, 0.03);
    scene.objects.push_back(table_item(k + 1, x, y, dice));
  }
  Object top{"table", {}, {Pattern::kMarble, {0.5, 0.33, 0.2}, {0.68, 0.48, 0.3}, 2.5, 0.08, 9}};
  top.solids.push_back(box({0, 0, -0.04}, kUpright, {1.0, 0.7, 0.04}, 0.01));
  for (const double x : {-0.9, 0.9})
    for (const double y : {-0.6, 0.6}) top.solids.push_back(cylinder({x, y, -0.42}, kUpright, 0.05, 0.38));
  scene.objects.push_back(top);
  scene.focus = {0, 0, 0};
  scene.rig_radius = 2.6;
}

constexpr double kWallX = -0.42, kWallY = -0.36;  // of the corner

/// A cabinet with a ball on it against two walls: floor and both walls meet behind it.
void corner(AnalyticScene& scene) {
  scene.objects = {
      {"cabinet",
       {box({0, 0, 0.36}, kUpright, {0.4, 0.34, 0.35}, 0.03), sphere({-0.05, 0.02, 0.88}, 0.18)},
       {Pattern::kMarble, {0.7, 0.3, 0.2}, {0.9, 0.75, 0.5}, 2.5, 0.1, 10}},
      {"ball", {sphere({0.72, 0.1, 0.2}, 0.2)}, {Pattern::kSpots, {0.15, 0.4, 0.3}, {0.7, 0.8, 0.5}, 4, 0.1, 11}}};
  scene.focus = {0.15, 0.1, 0.4};
  scene.rig_radius = 2.4;
  scene.open_side = 0.25 * kPi;
  scene.arc = 0.4 * kPi;
}

/// A statue on the cap of a large sphere with a checker.
void ground(AnalyticScene& scene) {
  const double radius = 6;
  scene.objects = {{"statue",
                    {box({0, 0, 0.1}, turned_about_z(0.4), {0.3, 0.24, 0.14}, 0.02),
                     cylinder({0, 0, 0.45}, kUpright, 0.12, 0.25), sphere({0, 0, 0.82}, 0.2)},
                    {Pattern::kMarble, {0.75, 0.7, 0.6}, {0.45, 0.4, 0.45}, 3, 0.1, 12}},
                   {"ground",
                    {sphere({0, 0, -radius}, radius)},
                    {Pattern::kChecker, {0.25, 0.42, 0.22}, {0.78, 0.7, 0.45}, 3, 0.1, 13}}};
  scene.focus = {0, 0, 0.4};
  scene.rig_radius = 2.6;
}

/// A bust on a turning plate in a dark room: the light moves over it from photo to photo.
void turntable(AnalyticScene& scene) {
  scene.objects = {
      {"bust",
       {box({0, 0, 0.13}, turned_about_z(0.4), {0.2, 0.16, 0.12}, 0.02), cylinder({0, 0, 0.4}, kUpright, 0.09, 0.16),
        sphere({0, 0, 0.66}, 0.17), sphere({0.15, 0.03, 0.64}, 0.05)},
       {Pattern::kMarble, {0.75, 0.7, 0.6}, {0.45, 0.4, 0.45}, 3, 0.1, 14}},
      {"plate",
       {cylinder({0, 0, -0.04}, kUpright, 0.5, 0.04)},
       {Pattern::kStripes, {0.2, 0.2, 0.22}, {0.4, 0.4, 0.42}, 4, 0.08, 15}}};
  scene.focus = {0, 0, 0.35};
  scene.rig_radius = 2.2;
  scene.light = {0.5, 0.6, 0.6};
  scene.ambient = 0.15;
  scene.turns = true;
}

int find_target(const std::vector<Object>& objects, const std::string& name) {
  if (name.empty()) return 0;
  std::string known;
  for (std::size_t i = 0; i < objects.size() && !objects[i].is_furniture; ++i) {
    if (objects[i].name == name) return int(i);
    known += (i ? ", " : "") + objects[i].name;
  }
  throw Error(ErrorCode::kUsage, "target: \"" + name + "\" is not an object of this scene, expected one of " + known);
}

V rig_position(const Recipe& recipe, const AnalyticScene& scene, int i, Dice& dice) {
  const double radius = scene.rig_radius * dice.uniform(0.95, 1.05);
  if (recipe.rig == Rig::kOrbit) {
    // The golden ratio spreads the elevations evenly over the azimuths for any number of views.
    const double part = std::fmod(0.5 + 0.6180339887 * i, 1.0);
    const double azimuth = scene.arc < 2 * kPi ? scene.open_side + scene.arc * ((i + 0.5) / recipe.views - 0.5)
                                               : 2 * kPi * i / recipe.views;
    const double elevation = (12 + 36 * part) * kPi / 180;
    return scene.focus + radius * V{std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                    std::sin(elevation)};
  }
  const int columns = std::max(1, int(std::ceil(std::sqrt(1.5 * recipe.views))));
  const int rows = (recipe.views + columns - 1) / columns;
  const int column = i % columns, row = i / columns;
  const double u = columns > 1 ? double(column) / (columns - 1) - 0.5 : 0;
  const double v = rows > 1 ? double(row) / (rows - 1) - 0.5 : 0;
  const V place{radius * 0.7 * u, -radius, radius * (0.35 + 0.4 * v)};
  return scene.focus + transpose(turned_about_z(scene.open_side + 0.5 * kPi)) * place;
}

}  // namespace

std::vector<std::string> recipe_names() {
  std::vector<std::string> names;
  for (const auto& kind : kSceneNames) names.emplace_back(kind.name);
  names.emplace_back("tiny");
  return names;
}

Recipe named_recipe(const std::string& name) {
  Recipe recipe;
  if (name == "messy") {
    recipe.views = 40;
    recipe.width_px = 400;
    recipe.height_px = 300;
    recipe.fov_deg = 60;
    recipe.samples_per_side = 2;
    recipe.points = 20000;
  }
  if (name == "tiny") {
    recipe.scene = SceneKind::kTwoSpheres;
    recipe.views = 6;
    recipe.width_px = 64;
    recipe.height_px = 48;
    recipe.points = 500;
    return recipe;
  }
  std::string known;
  for (const auto& kind : kSceneNames) {
    recipe.scene = kind.value;
    if (kind.name == name) return recipe;
  }
  for (const std::string& n : recipe_names()) known += n + ", ";
  throw Error(ErrorCode::kUsage, "recipe: \"" + name + "\" is unknown, expected " + known + "or a JSON file");
}

AnalyticScene build_scene(const Recipe& recipe) {
  AnalyticScene scene;
  Dice dice(std::uint64_t(recipe.scene_seed));
  double floor = 0;
  switch (recipe.scene) {
    case SceneKind::kTwoSpheres: two_spheres(scene); break;
    case SceneKind::kTorusBox: torus_box(scene); break;
    case SceneKind::kLeaves: leaves(scene, dice); break;
    case SceneKind::kBones: bones(scene); break;
    case SceneKind::kTable: table(scene, dice), floor = -0.8; break;
    case SceneKind::kCorner: corner(scene); break;
    case SceneKind::kGround: ground(scene), floor = -1.2; break;
    case SceneKind::kTurntable: turntable(scene), floor = -1.2; break;
    case SceneKind::kMessy: messy_room(scene, recipe.objects, std::uint64_t(recipe.scene_seed)); break;
  }
  const auto seed = std::uint32_t(recipe.scene_seed);
  for (Object& object : scene.objects) object.texture.seed += 101 * seed;
  const double half = 1.6 * scene.rig_radius;  // the farthest camera is at 1.25 radii
  scene.room = {{-half, -half, floor},
                {half, half, scene.focus.z + 1.5 * scene.rig_radius},
                {Pattern::kChecker, {0.42, 0.4, 0.38}, {0.66, 0.63, 0.58}, 1.6, 0.1, 91 + seed},
                {Pattern::kSpots, {0.36, 0.42, 0.5}, {0.6, 0.58, 0.5}, 0.7, 0.1, 92 + seed}};
  if (recipe.scene == SceneKind::kCorner) {
    scene.room.low.x = kWallX;
    scene.room.low.y = kWallY;
    scene.room.walls = {Pattern::kStripes, {0.36, 0.42, 0.5}, {0.6, 0.58, 0.5}, 2, 0.1, 92 + seed};
  }
  if (scene.turns) {
    scene.room.floor = {Pattern::kSpots, {0.03, 0.03, 0.04}, {0.1, 0.09, 0.08}, 1.6, 0.01, 91 + seed};
    scene.room.walls = {Pattern::kSpots, {0.04, 0.03, 0.03}, {0.08, 0.1, 0.09}, 0.7, 0.01, 92 + seed};
  }
  scene.light = normalized(scene.light);
  scene.gloss = recipe.gloss;
  scene.grey = recipe.grey;
  scene.cast_shadows = recipe.cast_shadows;
  scene.target = find_target(scene.objects, recipe.target);
  return scene;
}

Camera recipe_camera(const Recipe& recipe) {
  Camera camera;
  camera.width_px = recipe.width_px;
  camera.height_px = recipe.height_px;
  camera.fx = camera.fy = 0.5 * recipe.width_px / std::tan(0.5 * recipe.fov_deg * kPi / 180);
  camera.cx = 0.5 * camera.width_px;
  camera.cy = 0.5 * camera.height_px;
  return camera;
}

void look_at(Camera& camera, V centre, V at) {
  const V z = normalized(at - centre), x = normalized(cross(z, V{0, 0, 1})), y = cross(z, x);
  camera.rotation = {{x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z}};
  camera.translation = -1.0 * (camera.rotation * centre);
}

std::vector<Camera> build_rig(const Recipe& recipe, const AnalyticScene& scene) {
  Dice dice(std::uint64_t(recipe.scene_seed) + 1000003);
  std::vector<Camera> cameras;
  for (int i = 0; i < recipe.views; ++i) {
    Camera camera = recipe_camera(recipe);
    const std::string number = std::to_string(i);
    camera.name = std::string(number.size() < 4 ? 4 - number.size() : 0, '0') + number + ".png";
    const bool other_size = recipe.mixed_sizes && i % 4 == 1, shifted = i % 3 == 1;
    if (other_size) camera.width_px = std::max(8, recipe.width_px * 7 / 8);
    camera.cx = camera.width_px * (0.5 + (shifted ? recipe.principal_shift : 0));
    camera.cy = camera.height_px * (0.5 - (shifted ? 0.8 * recipe.principal_shift : 0));
    const V centre = rig_position(recipe, scene, i, dice);
    const double sway = 0.05 * scene.rig_radius;
    const double dx = dice.uniform(-sway, sway), dy = dice.uniform(-sway, sway), dz = dice.uniform(-sway, sway);
    look_at(camera, centre, scene.focus + V{dx, dy, dz});
    cameras.push_back(camera);
  }
  return cameras;
}

}  // namespace ngs::synth
