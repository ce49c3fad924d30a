#pragma once
// Analytic scenes by name, and their camera rigs.
//
// World units; +z is up.
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/make/synth/analytic_scene.h"
#include "ngs/options/field.h"
#include "ngs/scene/camera.h"

namespace ngs::synth {

enum class SceneKind : std::uint8_t {
  kTwoSpheres,
  kTorusBox,
  kLeaves,
  kBones,
  kTable,
  kCorner,
  kGround,
  kTurntable,
  kMessy
};
enum class Rig : std::uint8_t { kOrbit, kForward };
inline constexpr NamedValue<SceneKind> kSceneNames[] = {{SceneKind::kTwoSpheres, "two-spheres"},
                                                        {SceneKind::kTorusBox, "torus-box"},
                                                        {SceneKind::kLeaves, "leaves"},
                                                        {SceneKind::kBones, "bones"},
                                                        {SceneKind::kTable, "table"},
                                                        {SceneKind::kCorner, "corner"},
                                                        {SceneKind::kGround, "ground"},
                                                        {SceneKind::kTurntable, "turntable"},
                                                        {SceneKind::kMessy, "messy"}};
inline constexpr NamedValue<Rig> kRigNames[] = {{Rig::kOrbit, "orbit"}, {Rig::kForward, "forward"}};

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
  bool grey = false, cast_shadows = false;
  int points = 4000;
  int objects = 25;
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
    visit(self.cast_shadows, Flag{"cast_shadows", "Let the objects cast shadows, with a half-shadow at their edge"});
    visit(self.points, Field<int>{"points", "", "Sparse points sampled on the surfaces", 1, 10000000});
    visit(self.objects, Field<int>{"objects", "", "Number of objects of the scene messy", 1, 10000});
    visit(self.target, Text{"target", "NAME", "Object whose masks go to masks/; empty: the scene's first"});
    visit(self.scene_seed, Field<std::int64_t>{"scene_seed", "", "Seed of textures, layout and rig", 0, 1ll << 53});
  }
};

/// A recipe by name: the nine scenes, and `tiny` (two spheres, 6 views of 64x48, for tests). kUsage for other names.
Recipe named_recipe(const std::string& name);
std::vector<std::string> recipe_names();

/// Builds the scene of a recipe. For an unknown target throws kUsage with a list of the objects.
AnalyticScene build_scene(const Recipe& recipe);

/// The cameras, named 0000.png, 0001.png, …, all inside the room.
std::vector<Camera> build_rig(const Recipe& recipe, const AnalyticScene& scene);

/// A camera with the size and focal length of a recipe and a centred principal point, without a pose.
Camera recipe_camera(const Recipe& recipe);
/// Places the camera at `centre`, turned to `at`, the world's +z upwards in the image. The view must not be vertical.
void look_at(Camera& camera, Vec3<double> centre, Vec3<double> at);

}  // namespace ngs::synth
