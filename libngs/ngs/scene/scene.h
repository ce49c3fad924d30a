#pragma once
// The canonical description of a capture: the contents of scene.json, read by every tool.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ngs/scene/camera.h"
#include "ngs/scene/compat.h"
#include "ngs/scene/mask_threshold.h"
#include "ngs/scene/views.h"

namespace ngs {

enum class MaskMode : std::uint8_t { kBinary, kLabel, kSoft, kBands };
enum class MissingMask : std::uint8_t { kUnknown, kEmpty, kError };
enum class Split : std::uint8_t { kTrain, kHeldOut };

/// An object to segment. `id`: its value in label maps; 0 if the masks are not label maps.
struct SceneObject {
  std::string name = "object";
  std::uint32_t id = 0;
};

struct SceneView {
  Camera camera;           // at the working size (after image_scale)
  std::string image_path;  // absolute or relative to the working directory; empty: no photo
  std::string mask_path;   // empty: no mask for this view
  Split split = Split::kTrain;
};

/// Renders of the model used in place of photos, at cameras chosen for it. They contain no information beyond the
/// model.
struct RenderedPhotos {
  double coverage = 0;  // share of the visible surface covered by at least three views, in [0, 1]
};
/// Note about them in scene.json and reports.
inline constexpr const char* kRenderedPhotosNote = "renders of the model, no photos";

struct Scene {
  std::string model_path;
  std::vector<SceneView> views;      // sorted by name
  std::vector<SceneObject> objects;  // at least one
  MaskMode mask_mode = MaskMode::kBinary;
  bool mask_invert = false;
  double mask_threshold = kMaskThreshold;  // 8-bit scale; binary mode: object where value >= threshold
  std::optional<std::uint32_t> void_id;    // label maps: pixels with this id are unknown; none: all known
  MissingMask missing_mask = MissingMask::kUnknown;
  double image_scale = 1.0;
  double filter_px2 = 0.3;  // variance of the low-pass filter the model was fitted with, px² at the working size
  Compat compat = Compat::kInria;          // renderer that the model was fitted with
  double world_unit = 1;                   // world length that near planes count as 1 (world_unit.h)
  std::optional<bool> antialiased;         // fitted with Mip-Splatting's opacity compensation; none: see PLY comments
  std::optional<Vec3<double>> background;  // background colour in [0, 1]; none: unknown, treated as black
  std::optional<RenderedPhotos> renders;   // set: the photos are renders; none: real photos

  /// Masks are read as the tools write them: 0 background, 255 object.
  void use_binary_masks() {
    mask_mode = MaskMode::kBinary;
    mask_invert = false;
    mask_threshold = kMaskThreshold;
  }
};

/// The background of renders and of transparent photos, for every stage.
inline Vec3<float> background_of(const Scene& scene) {
  const Vec3<double> b = scene.background.value_or(Vec3<double>{0, 0, 0});
  return {float(b.x), float(b.y), float(b.z)};
}

/// The masks of one view at the camera's size, one plane per object.
struct ViewMasks {
  int width_px = 0, height_px = 0;
  std::vector<std::vector<float>> target;  // [K][H·W] in [0, 1]; exactly 0/1 for binary and label masks
  std::vector<std::uint8_t> known;         // [H·W] 0: no evidence; empty: all known (if `available`)
  bool available = false;                  // false: the view has no evidence
};

}  // namespace ngs
