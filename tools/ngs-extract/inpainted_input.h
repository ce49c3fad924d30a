#pragma once
// Pictures in which another program has inpainted the holes that --inpaint wrote.
#include <string>
#include <vector>

#include "extractor.h"
#include "ngs/edit/extract/inpaint_stage.h"
#include "ngs/edit/fill/fill_refit.h"
#include "ngs/scene/scene.h"
#include "ngs/scene/view_prompt.h"
#include "outputs.h"

namespace ngs::cli {

class InpaintedPictures {
 public:
  /// Finds the picture of each view of `scene` in `folder`: the name that --inpaint gave, with any extension, also
  /// followed by _mask*, _inpainted or the like. Throws kInconsistent for a picture of no view, and for one that is not
  /// of its camera's size, or up to 63 px larger. `scene` and `options`
  /// must outlive this object.
  InpaintedPictures(const Scene& scene, const std::string& folder, const InpaintOptions& options);

  /// Finds the holes as --inpaint does. Throws kBadInput if a view with a hole has no picture, kInconsistent for a
  /// picture of one colour; warns about pictures that differ from those of --inpaint. Call it after
  /// Extractor::decide().
  void find_holes(Run& run, const Extractor& extractor);

  /// For refit_hole(). Refers to this object.
  InpaintedViews views(const Run& run, const GaussianCloud& cloud) const;

 private:
  /// [H, W, 3] at the camera's size.
  ImageF picture(std::size_t view) const;

  const Scene& scene_;
  std::string folder_;
  const InpaintOptions& options_;
  std::vector<std::string> names_, paths_;  // [views]; a path may be empty
  std::vector<PixelMask> holes_;            // [views] with the margin of --inpaint-dilate-px
  std::vector<std::size_t> with_hole_;
  int padded_ = 0;  // pictures that are larger than their cameras
};

}  // namespace ngs::cli
