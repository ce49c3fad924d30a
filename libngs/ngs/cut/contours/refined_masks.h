#pragma once
// Refines the rendered masks of a labelled model to the edges of the photos.                     paper.md §5.10
#include "ngs/ops/image/contour_refine.h"
#include "ngs/ops/image/pixel_window.h"
#include "ngs/problem/problem.h"
#include "ngs/scene/rle_masks.h"

namespace ngs {

/// The refined masks of a view, in a window, and their comparison with the view's own masks.
struct RefinedView {
  PixelWindow window;
  double detail = 0;      // size of the photo relative to the camera's, before enlarging; 0: no photo
  RleMasks masks;         // of the window's size
  bool compared = false;  // true: a training view with masks; the members below are valid
  double rendered_biou = 0, refined_biou = 0;  // mean boundary IoU with the view's own masks
  double beyond_px2 = 0, short_px2 = 0;        // pixels only in the own masks; pixels only in the refined masks
  double own_contrast = 0, refined_contrast = 0, rendered_contrast = 0;  // of the photo across the contours
};

struct RefineSetup {
  const ContourRefineOptions& refine;
  double margin_px;  // of the windows
  const Problem& problem;
  int detail = 1;  // photos smaller than this multiple of the camera's size are enlarged to it
};

/// Refines the given views. Photos are read at up to twice the camera's size, and enlarged to setup.detail times it if
/// they are smaller. Returns [scene views]; other views, and views without a photo, are empty. Only the masks of the
/// views in `compared` are loaded, and compared with the refined ones.
std::vector<RefinedView> refine_views(const Exec& exec, const RefineSetup& setup, const LabelledModel& model,
                                      const std::vector<std::size_t>& views, const std::vector<std::size_t>& compared);

/// True: some compared view has a photo of less than `detail` times the camera's size.
bool could_enlarge(const std::vector<RefinedView>& refined, int detail);
/// refined_biou of the first minus that of the second, for the views that were compared in both.
std::vector<double> gains_over(const std::vector<RefinedView>& refined, const std::vector<RefinedView>& other);

/// Contours with less than this share of the refined contours' contrast do not lie on edges. In the synthetic scenes,
/// exact masks have 0.89 to 1.03, masks that are wrong by 2 px have 0.36 to 0.66.
inline constexpr double kOffEdges = 0.75;
/// True: the given masks' contours do not lie on edges, on average over the compared views.
bool masks_misaligned(const std::vector<RefinedView>& refined);
/// One-sided masks: the share of their difference from the refined masks by which one side outweighs the other exceeds
/// this. Masks that are all too large or too small have 0.9 to 1, masks with rounded corners 0.4 to 0.5, masks
/// displaced at random 0 to 0.25.
inline constexpr double kOneSided = 0.3;
bool masks_err_to_one_side(const std::vector<RefinedView>& refined);
/// Gain in agreement with the given masks by refinement: normal score of the mean gain over the compared views
/// (problem/scene_measures.h). 0 if the given masks are misaligned and err to one side. Errors to both sides cancel in
/// the mean over the views.
double mask_agreement_gain(const std::vector<RefinedView>& refined);

/// Mean colour difference across the contour of the mask [H, W], between pixels at distance 3, summed over the
/// channels; 0 without a contour. `photo` must have the mask's size.
double contour_contrast(const std::vector<std::uint8_t>& mask, const ImageF& photo);

/// The refined masks at the view's size `w` x `h`; 0 outside the window.
ViewMasks uncropped_masks(const RefinedView& refined, int w, int h);

}  // namespace ngs
