#pragma once
// A list of objects (unions of solids) in a textured room, so that no pixel is empty.
//
// Object k has the id k + 1; id 0 is the room and its furniture. World units; +z is up.
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/make/synth/synth_solids.h"

namespace ngs::synth {

struct Object {
  std::string name;
  std::vector<Solid> solids;
  Texture texture;
  bool visible = true;        // false: rays pass through, but it still shades what it touches
  bool is_furniture = false;  // has id 0; furniture follows all objects
};

/// The room, seen from inside: an axis-aligned box with one texture for the floor and one for the rest.
struct Room {
  Vec3<double> low{}, high{};
  Texture floor, walls;
};

struct AnalyticScene {
  std::vector<Object> objects;
  Room room;
  bool has_room = true;                  // false: rays that miss every object are black and have no depth (infinity)
  Vec3<double> light{0.45, -0.3, 0.84};  // unit, towards the light
  bool turns = false;  // the objects turn before a fixed camera: light and room follow the camera's azimuth
  double ambient = 0.4, gloss = 0;
  bool grey = false;  // images have luminance only
  bool cast_shadows = false;
  Vec3<double> focus{};   // the point that the cameras look at
  double rig_radius = 3;  // distance of the cameras from `focus`
  // The cameras' azimuths, rad: all of them, or an arc around the open side of a scene against walls.
  double open_side = -1.5707963267948966, arc = 6.283185307179586;
  int target = 0;  // index into objects
};

/// The id of objects[index] in label maps; -1 is the room.
inline std::uint16_t label_of(const AnalyticScene& scene, int index) {
  return index < 0 || scene.objects[std::size_t(index)].is_furniture ? std::uint16_t(0) : std::uint16_t(index + 1);
}

/// Number of objects without furniture: their ids are 1 to this.
inline std::size_t object_count(const AnalyticScene& scene) {
  std::size_t count = 0;
  for (const Object& object : scene.objects) count += !object.is_furniture;
  return count;
}

}  // namespace ngs::synth
