#pragma once
// Options of contour refinement.                                                                 paper.md §5.10
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "ngs/cut/training/joint_options.h"
#include "ngs/ops/image/contour_refine.h"
#include "ngs/options/field.h"

namespace ngs {

enum class ContourViews : std::uint8_t { kAll, kTrain };
inline constexpr NamedValue<ContourViews> kContourViewsNames[] = {{ContourViews::kAll, "all"},
                                                                  {ContourViews::kTrain, "train"}};

/// What a view without a photo is trained on: kLeave: nothing; kPicture: the model's own rendering; kAuto: the better
/// of both, as measured on views with a photo.
enum class PhotolessViews : std::uint8_t { kAuto, kLeave, kPicture };
inline constexpr NamedValue<PhotolessViews> kPhotolessViewsNames[] = {
    {PhotolessViews::kAuto, "auto"}, {PhotolessViews::kLeave, "leave"}, {PhotolessViews::kPicture, "picture"}};

/// The effects split, contour-iterations and full-resolution.
struct ContourSwitches {
  bool split = true;            // halve Gaussians that straddle contours
  bool iterations = true;       // run more than one iteration
  bool full_resolution = true;  // in all iterations; false: only in the last
};

/// Gaussians with more weight on the wrong side of contours are halved.
inline constexpr double kSplit_px = 3;

struct ContourOptions {
  int iterations = 0, epochs = 0;  // 0: contour_iterations(), contour_epochs()
  ContourViews views = ContourViews::kAll;
  PhotolessViews photoless = PhotolessViews::kAuto;
  ContourRefineOptions refine;
  double margin_px = 64;  // of the trained windows; not an option
  ContourSwitches on;     // set by the decisions on effects

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.iterations, Field<int>{"contour_iterations", "",
                                      "Number of refinements; 0: 2, or 3 if the masks' contours miss the photos' "
                                      "edges; one less in a draft, 2 more at high, 5 more at reference",
                                      0, 100}
                               .of("contour-iterations"));
    visit(self.epochs,
          Field<int>{"contour_epochs", "",
                     "Epochs per iteration, half as many at half resolution; 0: for 21 views 10 (draft: 4, from high: "
                     "15), with fewer views more, at most 15, and with more views fewer",
                     0, 1'000'000});
    visit(self.views, Choice<ContourViews>{"contour_views", "Views whose photos are used; held-out masks never are",
                                           kContourViewsNames});
    visit(self.photoless,
          Choice<PhotolessViews>{
              "contour_photoless",
              "Views without a photo: choose by a trial, leave them out, or train on pictures of the model",
              kPhotolessViewsNames});
    visit(self.refine.band_px,
          Field<double>{"contour_band", "px of the photo", "Largest move of a contour in one iteration", 0.5, 1e3});
  }
};

/// With more views than this, the default number of epochs falls so that steps grow with the square root of the number
/// of views. With fewer views it rises, up to kMostContourEpochs, so that the number of steps stays.
inline constexpr int kViewsOfPresetEpochs = 21, kMostContourEpochs = 15;

/// Epochs of the last iteration for this number of views.
inline int contour_epochs(const ContourOptions& contour, Quality quality, std::size_t views) {
  if (contour.epochs > 0) return contour.epochs;
  const double share = double(kViewsOfPresetEpochs) / double(std::max<std::size_t>(views, 1));
  const double epochs = preset_of(quality).contour_epochs * (share < 1 ? std::sqrt(share) : share);
  return int(std::ceil(std::min<double>(epochs, kMostContourEpochs)));
}

/// Number of iterations. `misaligned`: the masks' contours miss the photos' edges by more than one refinement moves.
inline int contour_iterations(const ContourOptions& contour, Quality quality, bool misaligned) {
  return contour.iterations > 0 ? contour.iterations : (misaligned ? 3 : 2) + preset_of(quality).more_iterations;
}

/// Epochs of an iteration at half the size, if the last iteration has `epochs`.
inline int early_epochs(int epochs) {
  constexpr double kShare = 0.5;
  return int(std::ceil(kShare * epochs));
}

}  // namespace ngs
