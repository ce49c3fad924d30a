#include "ngs/cut/groups/surface_parts.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <set>

#include "ngs/cut/groups/room_surfaces.h"
#include "ngs/make/synth/synth_scene.h"

namespace ngs {
namespace {

using V = Vec3<double>;

struct Box {
  V low, high, colour;
};

struct Hit {
  double depth = 1e9;
  V colour{0.5, 0.5, 0.5};
};

/// The first box, the floor z = 0 within 3 of the middle, or the wall y = 3, along camera axes.
Hit hit_along(const V& from, const V& direction, const std::vector<Box>& boxes) {
  Hit hit;
  double& nearest = hit.depth;
  const double floor = -from.z / direction.z, wall = (3 - from.y) / direction.y;
  const V on_floor = from + floor * direction, on_wall = from + wall * direction;
  if (floor > 0 && std::max(std::abs(on_floor.x), std::abs(on_floor.y)) < 3) nearest = floor;
  if (wall > 0 && std::abs(on_wall.x) < 3 && on_wall.z > 0 && on_wall.z < 2) nearest = std::min(nearest, wall);
  for (const Box& box : boxes) {
    double enter = 0, leave = 1e9;
    for (const double V::*axis : {&V::x, &V::y, &V::z}) {
      const double a = (box.low.*axis - from.*axis) / (direction.*axis),
                   b = (box.high.*axis - from.*axis) / (direction.*axis);
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    if (enter > 0 && enter < leave && enter < nearest) hit = {enter, box.colour};
  }
  return hit;
}

/// Sixteen views from around at two heights.
std::vector<DepthView> views_of(const std::vector<Box>& boxes) {
  std::vector<DepthView> views;
  for (int k = 0; k < 16; ++k) {
    Camera camera{.name = {}, .width_px = 320, .height_px = 240, .fx = 300, .fy = 300, .cx = 160, .cy = 120};
    const double angle = 0.1 + k * 0.3927;
    synth::look_at(camera, {2.4 * std::cos(angle), 2.4 * std::sin(angle), k % 2 ? 0.9 : 1.9}, {0, 0, 0.3});
    DepthView view{camera, ImageF(320, 240, 1), ImageF(320, 240, 3)};
    for (int y = 0; y < 240; ++y)
      for (int x = 0; x < 320; ++x) {
        const V ray{(x + 0.5 - camera.cx) / camera.fx, (y + 0.5 - camera.cy) / camera.fy, 1};
        const Hit hit = hit_along(camera.centre(), transpose(camera.rotation) * ray, boxes);
        view.depth.at(x, y) = hit.depth < 1e9 ? float(hit.depth) : 0.f;
        const double colour[3] = {hit.colour.x, hit.colour.y, hit.colour.z};
        for (int c = 0; c < 3; ++c) view.colour.at(x, y, c) = float(colour[c]);
      }
    views.push_back(std::move(view));
  }
  return views;
}

Box box_at(V base, V half, V colour) {
  return {base - V{half.x, half.y, 0}, base + V{half.x, half.y, 2 * half.z}, colour};
}

/// The part at most of the surface points of a box above `from`.
int part_of(const Box& box, const std::vector<DepthView>& views, const SurfaceCells& cells, const SurfaceParts& parts) {
  std::map<int, int> count;
  constexpr double kEdge = 1e-3;
  for (const DepthView& view : views) {
    const NumberedMasks masks = masks_of_parts(view, cells, parts);
    for (int y = 0; y < view.depth.height_px; ++y)
      for (int x = 0; x < view.depth.width_px; ++x) {
        if (view.depth.at(x, y) == 0) continue;
        const V p = view.point(x, y);
        if (p.x > box.low.x - kEdge && p.x < box.high.x + kEdge && p.y > box.low.y - kEdge &&
            p.y < box.high.y + kEdge && p.z > box.low.z + 0.05 && p.z < box.high.z + kEdge)
          ++count[masks.number.at(x, y)];
      }
  }
  int all = 0;
  for (const auto& [part, pixels] : count) all += pixels;
  for (const auto& [part, pixels] : count)
    if (pixels > 0.9 * all) return part;
  return -1;
}

const V kRed{0.8, 0.1, 0.1}, kGreen{0.1, 0.7, 0.2}, kBlue{0.1, 0.2, 0.9}, kBrown{0.5, 0.3, 0.1};
const Box kTable = box_at({-0.7, 0, 0}, {0.45, 0.45, 0.2}, kBrown),
          kPedestal = box_at({0.7, 0.4, 0}, {0.15, 0.15, 0.15}, kGreen),
          kStatue = box_at({0.7, 0.4, 0.3}, {0.1, 0.1, 0.15}, kRed),
          kFirst = box_at({-0.5, 0.2, 0.4}, {0.08, 0.08, 0.08}, kRed),
          kSecond = box_at({-0.8, -0.2, 0.4}, {0.07, 0.1, 0.1}, kGreen),
          kSmallBox = box_at({0.5, -0.6, 0}, {0.1, 0.1, 0.1}, kBlue);

}  // namespace

TEST_CASE("a table, boxes on it, a box alone and two boxes on each other are parts; floor and wall are none") {
  const std::vector<Box> boxes{kTable, kPedestal, kStatue, kFirst, kSecond, kSmallBox};
  const std::vector<DepthView> views = views_of(boxes);
  const SurfaceCells cells = surface_cells({}, views);
  REQUIRE(cells.count() > 5000);
  const SurfaceParts parts = surface_parts(cells, unit(V{0.05, -0.05, 1}));
  CHECK(parts.parts == 6);
  std::set<int> different;
  for (const Box& box : boxes) {
    const int part = part_of(box, views, cells, parts);
    CHECK(part > 0);
    different.insert(part);
  }
  CHECK(different.size() == 6);
  for (const V at : {V{0, -1.5, 0}, V{0.2, 2.999, 1}}) {
    const std::int64_t cell = cells.at(at);
    REQUIRE(cell >= 0);
    CHECK(parts.part[std::size_t(cell)] == 0);
  }
}

TEST_CASE("two walls of one colour that meet in a corner remove only what is as far out as one of them") {
  const Box wall = box_at({0, 2.6, 0}, {2.65, 0.05, 0.8}, kBlue), other = box_at({2.6, 0, 0}, {0.05, 2.65, 0.8}, kBlue);
  const std::vector<Box> boxes{kPedestal, kStatue, box_at({1.4, 1.4, 0}, {0.2, 0.2, 0.2}, kGreen)};
  std::vector<Box> all = boxes;
  all.insert(all.end(), {wall, other});
  const std::vector<DepthView> views = views_of(all);
  const SurfaceCells cells = surface_cells({}, views);
  const SurfaceParts parts = surface_parts(cells, {0, 0, 1});
  for (const Box& box : boxes) CHECK(part_of(box, views, cells, parts) > 0);
  for (const Box& box : {wall, other}) CHECK(part_of(box, views, cells, parts) == 0);
}

TEST_CASE("two boxes on each other are one part if they have the same colours") {
  Box statue = kStatue;
  statue.colour = kPedestal.colour;
  const std::vector<DepthView> views = views_of({kPedestal, statue});
  const SurfaceCells cells = surface_cells({}, views);
  const SurfaceParts parts = surface_parts(cells, {0, 0, 1});
  CHECK(parts.parts == 1);
  CHECK(part_of(statue, views, cells, parts) == 1);
  CHECK(part_of(kPedestal, views, cells, parts) == 1);
}

TEST_CASE("a low board, two thirds of which face upwards, is no part, and what stands on it is one") {
  const Box board = box_at({-0.2, 0, 0}, {0.45, 0.45, 0.06}, kBrown),
            box = box_at({-0.2, 0, 0.12}, {0.1, 0.1, 0.1}, kRed);
  const std::vector<DepthView> views = views_of({board, box});
  const SurfaceCells cells = surface_cells({}, views);
  const SurfaceParts parts = surface_parts(cells, {0, 0, 1});
  CHECK(parts.parts == 1);
  CHECK(part_of(box, views, cells, parts) == 1);
}

TEST_CASE("a view without surface has no cells, and no cells have no parts") {
  DepthView empty{views_of({})[0].camera, ImageF(320, 240, 1), ImageF(320, 240, 3)};
  const SurfaceCells none = surface_cells({}, {empty, empty});
  CHECK(none.count() == 0);
  CHECK(surface_parts(none, {0, 0, 1}).parts == 0);
  CHECK(surface_cells({}, {}).count() == 0);
  const NumberedMasks masks = masks_of_parts(empty, none, {});
  CHECK(std::ranges::count(masks.number.data, NumberedMasks::kUnknown) == std::ssize(masks.number.data));
}

TEST_CASE("cells and parts do not depend on the number of threads") {
  const std::vector<DepthView> views = views_of({kTable, kFirst, kSecond});
  const SurfaceCells a = surface_cells({.threads = 1}, views), b = surface_cells({.threads = 3}, views);
  CHECK(a.key == b.key);
  CHECK(a.neighbour == b.neighbour);
  CHECK(surface_parts(a, {0, 0, 1}).part == surface_parts(b, {0, 0, 1}).part);
}

namespace {

struct Room {
  GaussianCloud cloud;
  GroupedObjects objects;

  /// Adds an object: a grid of balls of 0.05 from `low` to `high`, 0.1 apart.
  void add(Vec3<float> low, Vec3<float> high) {
    const auto object = std::uint32_t(objects.objects.size() + 1);
    for (float x = low.x; x <= high.x; x += 0.1f)
      for (float y = low.y; y <= high.y; y += 0.1f)
        for (float z = low.z; z <= high.z; z += 0.1f) {
          const auto i = std::size_t(cloud.size());
          cloud.resize(std::int64_t(i) + 1, 0);
          const float at[3] = {x, y, z};
          std::copy_n(at, 3, &cloud.position[3 * i]);
          std::fill_n(&cloud.log_scale[3 * i], 3, -3.f);
          cloud.rotation[4 * i] = 1;
          cloud.logit_opacity[i] = 3;
          objects.object.push_back(object);
        }
    objects.objects.push_back({1, {0}, 1, 0, 0});
    objects.sure = objects.objects.size();
  }
};

}  // namespace

TEST_CASE("floor and wall are no objects; a table top, which has something on both sides, and what stands on it are") {
  Room room;
  room.add({-2, -2, 0}, {2, 2, 0.05f});                 // 1: floor
  room.add({-2, 2.1f, 0}, {2, 2.15f, 2});               // 2: wall
  room.add({-0.8f, -0.8f, 0.7f}, {0.8f, 0.8f, 0.75f});  // 3: table top
  room.add({-0.2f, -0.2f, 0.8f}, {0.2f, 0.2f, 1.2f});   // 4: on it
  room.objects.objects[2].part_of = 1;
  room.objects.objects[2].part_share = 0.5;
  room.objects.objects[3].part_of = 3;
  room.objects.objects[3].part_share = 0.5;
  const std::vector<std::uint32_t> before = room.objects.object;
  CHECK(remove_room_surfaces(room.cloud, {0, 0, 1}, room.objects) == 2);
  REQUIRE(room.objects.objects.size() == 2);
  CHECK(room.objects.sure == 2);
  for (std::size_t i = 0; i < before.size(); ++i) CHECK(room.objects.object[i] == (before[i] > 2 ? before[i] - 2 : 0));
  CHECK(room.objects.objects[0].part_of == 0);
  CHECK(room.objects.objects[0].part_share == 0);
  CHECK(room.objects.objects[1].part_of == 1);
}

TEST_CASE("a small box alone is no surface of a room, and a model without Gaussians has none") {
  Room room;
  room.add({0, 0, 0}, {1, 1, 1});
  CHECK(remove_room_surfaces(room.cloud, {0, 0, 1}, room.objects) == 0);
  CHECK(room.objects.sure == 1);
  Room none;
  CHECK(remove_room_surfaces(none.cloud, {0, 0, 1}, none.objects) == 0);
}

}  // namespace ngs
