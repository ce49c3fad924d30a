#pragma once
// Builds a Scene from cameras, photos, masks and a model of any origin: ngs-scene import without the checks that need
// the model (capture/scene_check.h).
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ngs/io/capture/capture_source.h"
#include "ngs/io/scene/unfit_masks.h"
#include "ngs/scene/scene.h"

namespace ngs::io {

inline constexpr const char* kAlphaRule = "alpha of the photo";  // in views_by_mask_rule
inline constexpr int kWorkingSizePx = 800;                       // longest side that the automatic image_scale allows

struct ImportRequest {
  CaptureRequest capture;
  std::string model_path;               // empty: searched next to the cameras
  std::string masks_dir;                // replaces the source's masks; empty: masks/ next to the cameras, or the only
                                        // other folder *mask*, except ground truth (*_gt, gt*), or masks_sam/
  std::string truth_dir;                // empty: masks_gt/ or gt/ next to the cameras
  std::vector<std::string> object_ids;  // "7", "cup=7" (label maps), "cup" (one folder per object)
  std::string hold_out;                 // "every:N:K", a file of names, or empty
  MaskMode mask_mode = MaskMode::kBinary;
  bool mask_invert = false;
  double mask_threshold = kMaskThreshold;
  std::optional<std::uint32_t> void_id;  // label maps
  MissingMask missing_mask = MissingMask::kUnknown;
  bool masks_in_order = false;  // masks and views are paired in the order of their names
  int mask_shift = 0;           // a view gets the mask that is this many names later than its own
  double image_scale = 1;       // (0, 1]; 0: automatic, see kWorkingSizePx
};

struct ImportedScene {
  Scene scene;
  std::string format;
  std::string cameras_file, images_dir, masks_dir;
  std::string truth_dir;  // folder of true masks, not read; empty: none
  std::map<std::string, int> views_by_mask_rule;
  UnfitMasks unfit_masks;  // empty if some view has a mask
  std::vector<std::string> notes;
};

/// A bad --object-id or --hold-out is kUsage; other errors are those of the readers. Label maps without object_ids:
/// every id except 0 and void_id that occurs in a mask becomes an object "object-<id>".
ImportedScene import_scene(const ImportRequest& request);

/// `hold_out` as above. kInconsistent for a name that matches no view, or if no view is left for training.
void assign_splits(const std::string& hold_out, std::vector<SceneView>& views);

}  // namespace ngs::io
