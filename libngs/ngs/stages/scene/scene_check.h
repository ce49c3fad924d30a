#pragma once
// Does a scene hold together? Cameras against model, model against photos, masks against cameras and against
// common sense. Photos and masks come through callbacks, one view at a time; masks of held-out views are
// never asked for.
//
// Refused (kInconsistent): the model explains the photos no better than a constant colour does (median over
// the checked views below `min_fit_db`), or, without photos, fewer than 1 % of the Gaussians inside the
// median view; an object whose masks are all empty or all full. kNothingFound: a model without a usable
// Gaussian.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "ngs/core/monitor.h"
#include "ngs/options/field.h"
#include "ngs/scene/scene.h"
#include "ngs/stages/scene/pose_check.h"

namespace ngs {

struct SceneCheckOptions {
  int check_views = 4;
  int check_size_px = 512;
  double min_fit_db = 3.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.check_views,
          Field<int>{"check_views", "", "photos to compare the rendered model with, evenly spaced; 0: none",
                     0, 100000});
    visit(self.check_size_px,
          Field<int>{"check_size_px", "px", "longest side of these comparisons", 16, 65536});
    visit(self.min_fit_db,
          Field<double>{"min_fit_db", "dB",
                        "refuse where the model's PSNR exceeds that of the photo's mean colour by less",
                        -100.0, 100.0});
  }
};

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

struct SceneCheck {
  std::vector<ViewCheck> views;      // [views of the scene]
  std::vector<ObjectCheck> objects;  // [objects of the scene]
  double median_fit_db = 0, median_psnr_db = 0, median_inside = 0;
  std::int64_t sampled_gaussians = 0;  // how many the shares are taken over
  std::vector<std::string> warnings;
};

/// `cloud` may be null (a scene before its model is fitted): then only masks are checked.
SceneCheck check_scene(const Exec& exec, Monitor& monitor, const SceneCheckOptions& options,
                       const GaussianCloud* cloud, const Scene& scene, const SceneLoaders& loaders);

/// `count` evenly spaced indices below n, the middle of each of `count` equal parts.
std::vector<std::size_t> evenly_spaced(std::size_t count, std::size_t n);

}  // namespace ngs
