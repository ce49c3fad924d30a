#pragma once
// Checks the consistency of a scene: cameras against model, model against photos, masks against cameras and model.
// Photos and masks are loaded through callbacks, one view at a time; masks of held-out views are never loaded.
//
// Throws kInconsistent in these cases:
//   - The model matches the photos no better than a constant colour (median over the checked views below `min_fit_db`).
//   - Without photos: fewer than 1 % of the Gaussians are inside the median view.
//   - All masks of an object are empty, or all are full.
//   - The masks of the only object cover most of the images and of their borders (`check_polarity`).
// Throws kNothingFound for a model without a usable Gaussian.
#include <functional>
#include <string>
#include <vector>

#include "ngs/capture/scene_findings.h"
#include "ngs/core/monitor.h"
#include "ngs/options/field.h"

namespace ngs {

struct SceneCheckOptions {
  int check_views = 4;
  int check_size_px = 512;  // longest side of the compared images; no option sets it
  double min_fit_db = 3.0;
  bool check_polarity = true;
  // What --world-transform takes: searched only for a model that does not fit. No option sets it.
  struct WorldFile {
    std::string word = "dataparser_transforms.json";
    std::function<Camera(Camera)> apply;  // null: no such file
  };
  std::function<WorldFile()> world_transform = [] { return WorldFile(); };

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.check_views,
          Field<int>{"check_views", "", "Number of evenly spaced photos to compare with renders of the model; 0: none",
                     0, 100000});
    visit(self.min_fit_db,
          Field<double>{"min_fit_db", "dB",
                        "Fail if the model's PSNR exceeds that of the photo's mean colour by less than this", -100.0,
                        100.0});
    visit(self.check_polarity,
          Flag{"check_polarity", "Fail if masks look inverted: they cover most of the images and of their borders"});
  }
};

struct SceneCheckInputs {
  const GaussianCloud* cloud;  // null (a scene before its model is fitted): only masks are checked
  const Scene& scene;
  const SceneLoaders& loaders;
  bool compat_is_default = false;  // the renderer of the fit is not given: the photos decide
};

SceneCheck check_scene(const Exec& exec, Monitor& monitor, const SceneCheckOptions& options,
                       const SceneCheckInputs& in);

}  // namespace ngs
