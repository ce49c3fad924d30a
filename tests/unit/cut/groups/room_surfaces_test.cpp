// ngs/cut/groups/room_surfaces.h: a floor, a wall, a table top and a box of Gaussians.
#include "ngs/cut/groups/room_surfaces.h"

#include <doctest/doctest.h>

namespace ngs {
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
