#pragma once
// Inputs and results of a scene check (capture/scene_check.h).
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "ngs/capture/pose_check.h"
#include "ngs/scene/scene.h"

namespace ngs {

/// The masks of one view and notes on reading them.
struct MaskSample {
  ViewMasks masks;
  std::vector<std::string> notes;  // "<file>: <note>"
  bool lossy = false;              // from JPEG files
};

struct SceneLoaders {
  std::function<ImageF(std::size_t view)> photo;      // at the camera's size; empty: none
  std::function<MaskSample(std::size_t view)> masks;  // at the camera's size
};

struct MaskCheck {
  std::vector<double> coverage;  // [K] fraction of the known pixels
  double known = 1;              // fraction of all pixels
};

struct ViewCheck {
  double in_front = 0;  // fraction of the usable Gaussians with camera z > 0
  double inside = 0;    // fraction whose centre projects into the image
  std::optional<PhotoMatch> match;
  std::optional<MaskCheck> masks;
};

struct ObjectCheck {
  int views = 0, empty = 0, full = 0;  // views with a mask, with an empty mask, with a full mask
  double mean_coverage = 0;
  double border = 0;                  // mean covered fraction of the image's border: high for inverted masks
  int all_round = 0, inside = 0;      // views whose mask covers nearly all of the image's border, nearly nothing of it
  double single = 0;                  // mean fraction of pixels that differ from their four neighbours: high for noise
  std::size_t hash = 0;               // of the masks of all views, if there are several objects
  int rectangles = 0;                 // views whose mask is an upright rectangle within the image
  std::size_t rectangle_view = 0;     // one of them
  std::array<int, 4> rectangle_px{};  // there: x0 y0 x1 y1
};

/// Views whose masks are empty for all objects, or full for one (capture/uniform_masks.h).
struct UniformMasks {
  std::vector<std::size_t> views;
  std::vector<std::size_t> contradicted;  // of these: the other masks show an object there
  double agreement = 1;                   // IoU of rendered labels and masks that are not empty; 1: not measured
};

struct SceneCheck {
  std::vector<ViewCheck> views;      // [views of the scene]
  std::vector<ObjectCheck> objects;  // [objects of the scene]
  UniformMasks uniform_masks;
  double median_fit_db = 0, median_psnr_db = 0, median_inside = 0;
  std::int64_t sampled_gaussians = 0;  // number of Gaussians that in_front and inside are measured on
  std::vector<std::string> warnings;
  Compat compat = Compat::kInria;  // the scene's; gsplat if that is a default and gsplat matches the photos better
  double world_unit = 1;           // the same; below 1 if near planes of a small world match better
};

}  // namespace ngs
