#pragma once
// What a check of a scene reads, and what it finds (stages/scene/scene_check.h).
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "ngs/scene/scene.h"
#include "ngs/stages/scene/pose_check.h"

namespace ngs {

/// The masks of one view and what reading them took.
struct MaskSample {
  ViewMasks masks;
  std::vector<std::string> notes;  // "<file>: <what>"
  bool lossy = false;              // from JPEG files
};

struct SceneLoaders {
  std::function<ImageF(std::size_t view)> photo;      // at the camera's size; empty: none
  std::function<MaskSample(std::size_t view)> masks;  // at the camera's size
};

struct MaskCheck {
  std::vector<double> coverage;  // [K] share of the known pixels
  double known = 1;              // share of the pixels
};

struct ViewCheck {
  double in_front = 0;  // share of the usable Gaussians with camera z > 0
  double inside = 0;    // share whose centre projects into the image
  std::optional<PhotoMatch> match;
  std::optional<MaskCheck> masks;
};

struct ObjectCheck {
  int views = 0, empty = 0, full = 0;  // with a mask; of these without a pixel, without another pixel
  double mean_coverage = 0;
  double border = 0;  // mean share of the image's border: high for inverted masks
};

/// Views whose masks are empty, of all objects (stages/scene/empty_masks.h).
struct EmptyMasks {
  std::vector<std::size_t> views;
  std::vector<std::size_t> contradicted;  // of these: the other masks show an object there
  double agreement = 1;                   // of such renders with masks that are not empty, IoU; 1: not asked
};

struct SceneCheck {
  std::vector<ViewCheck> views;      // [views of the scene]
  std::vector<ObjectCheck> objects;  // [objects of the scene]
  EmptyMasks empty_masks;
  double median_fit_db = 0, median_psnr_db = 0, median_inside = 0;
  std::int64_t sampled_gaussians = 0;  // how many the shares are taken over
  std::vector<std::string> warnings;
  Compat compat = Compat::kInria;  // the scene's; gsplat where it is a default and the photos fit better by gsplat's
};

}  // namespace ngs
