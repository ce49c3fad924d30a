#pragma once
// Analytic scenes by name, and their camera rigs.
//
// A scene is a list of objects (unions of solids) in a textured room, so that no pixel is empty. Object k has the id
// k + 1; id 0 is the room. World units; +z is up.
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/make/synth/synth_solids.h"
#include "ngs/options/field.h"
#include "ngs/scene/camera.h"

namespace ngs::synth {

enum class SceneKind : std::uint8_t { kTwoSpheres, kTorusBox, kLeaves, kBones, kTable, kCorner, kGround, kTurntable };
enum class Rig : std::uint8_t { kOrbit, kForward };
inline constexpr NamedValue<SceneKind> kSceneNames[] = {{SceneKind::kTwoSpheres, "two-spheres"},
                                                        {SceneKind::kTorusBox, "torus-box"},
                                                        {SceneKind::kLeaves, "leaves"},
                                                        {SceneKind::kBones, "bones"},
                                                        {SceneKind::kTable, "table"},
                                                        {SceneKind::kCorner, "corner"},
                                                        {SceneKind::kGround, "ground"},
                                                        {SceneKind::kTurntable, "turntable"}};
inline constexpr NamedValue<Rig> kRigNames[] = {{Rig::kOrbit, "orbit"}, {Rig::kForward, "forward"}};

/// All parameters of a scene.
struct Recipe {
  SceneKind scene = SceneKind::kTorusBox;
  Rig rig = Rig::kOrbit;
  int views = 20;
  int width_px = 320, height_px = 240;
  double fov_deg = 50;
  int samples_per_side = 4;
  double principal_shift = 0.05;
  bool mixed_sizes = false;
  double gloss = 0.15;
  bool grey = false;
  int points = 4000;
  std::string target;
  std::int64_t scene_seed = 1;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.scene, Choice<SceneKind>{"scene", "Objects to place in the room", kSceneNames});
    visit(self.rig, Choice<Rig>{"rig", "Arrangement of the cameras", kRigNames});
    visit(self.views, Field<int>{"views", "", "Number of cameras", 1, 10000});
    visit(self.width_px, Field<int>{"width_px", "px", "Image width", 8, 16384});
    visit(self.height_px, Field<int>{"height_px", "px", "Image height", 8, 16384});
    visit(self.fov_deg, Field<double>{"fov_deg", "deg", "Horizontal field of view", 5, 120});
    visit(self.samples_per_side, Field<int>{"samples_per_side", "", "Colour samples per pixel and axis", 1, 16});
    visit(self.principal_shift,
          Field<double>{"principal_shift", "of the size", "Offset of the principal point in every third view", 0, 0.4});
    visit(self.mixed_sizes, Flag{"mixed_sizes", "Give every fourth view another image size"});
    visit(self.gloss, Field<double>{"gloss", "", "Strength of the view-dependent highlight", 0, 1});
    visit(self.grey, Flag{"grey", "Use luminance only, so that colour does not separate the objects"});
    visit(self.points, Field<int>{"points", "", "Sparse points sampled on the surfaces", 1, 10000000});
    visit(self.target, Text{"target", "NAME", "Object whose masks go to masks/; empty: the scene's first"});
    visit(self.scene_seed, Field<std::int64_t>{"scene_seed", "", "Seed of textures, layout and rig", 0, 1ll << 53});
  }
};

/// A recipe by name: the eight scenes, and `tiny` (two spheres, 6 views of 64x48, for tests). Throws kUsage for an
/// unknown name.
Recipe named_recipe(const std::string& name);
std::vector<std::string> recipe_names();

struct Object {
  std::string name;
  std::vector<Solid> solids;
  Texture texture;
  bool visible = true;  // false: rays pass through, but it still shades what it touches
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
  bool grey = false;      // images have luminance only
  Vec3<double> focus{};   // the point that the cameras look at
  double rig_radius = 3;  // distance of the cameras from `focus`
  // The cameras' azimuths, rad: all of them, or an arc around the open side of a scene against walls.
  double open_side = -1.5707963267948966, arc = 6.283185307179586;
  int target = 0;  // index into objects
};

/// Builds the scene of a recipe. For an unknown target throws kUsage with a list of the objects.
AnalyticScene build_scene(const Recipe& recipe);

/// The cameras, named 0000.png, 0001.png, …, all inside the room.
std::vector<Camera> build_rig(const Recipe& recipe, const AnalyticScene& scene);

/// A camera with the size and focal length of a recipe and a centred principal point, without a pose.
Camera recipe_camera(const Recipe& recipe);
/// Places the camera at `centre` and turns it to `at`, the world's +z upwards in the image. The view must not be
/// vertical.
void look_at(Camera& camera, Vec3<double> centre, Vec3<double> at);

}  // namespace ngs::synth
