#pragma once
// Masks of a labelled model refined to the edges of the photos, view by view.             PAPER.md §5.10
#include "ngs/ops/image/contour_refine.h"
#include "ngs/problem/pixel_window.h"
#include "ngs/problem/problem.h"
#include "ngs/scene/rle_masks.h"

namespace ngs {

/// What an iteration trains a view on: the window and, in it, the refined masks.
struct RefinedView {
  PixelWindow window;
  double detail = 0;  // size of the photo relative to the camera's, before any enlarging
  RleMasks masks;     // of the window's size
  // Mean boundary IoU with the view's own masks; only where the view supervises and has them.
  bool compared = false;
  double rendered_biou = 0, refined_biou = 0;
  double beyond_px2 = 0, short_px2 = 0;  // what the own masks have that the refined ones have not, and the other way
  double own_contrast = 0, refined_contrast = 0, rendered_contrast = 0;  // of the photo across the contours
};

struct RefineSetup {
  const ContourRefineOptions& refine;
  double margin_px;  // of the windows
  const Problem& problem;
  int detail = 1;  // photos with fewer pixels than this many times the camera's size are enlarged to it
};

/// Photos are read at up to twice the camera's size, and enlarged to setup.detail times it. [scene views] the given
/// views refined, the others empty, as is a view without a photo. The masks of the views in `compared` are loaded and
/// compared with; no other mask is read.
std::vector<RefinedView> refine_views(const Exec& exec, const RefineSetup& setup, const LabelledModel& model,
                                      const std::vector<std::size_t>& views, const std::vector<std::size_t>& compared);

/// Whether some view that was compared was refined in a photo of less than `detail` times the camera's size.
bool could_enlarge(const std::vector<RefinedView>& refined, int detail);
/// refined_biou of the one less that of the other, of the views that were compared in both.
std::vector<double> gains_over(const std::vector<RefinedView>& refined, const std::vector<RefinedView>& other);

/// refined_biou - rendered_biou of the views that were compared.
std::vector<double> refinement_gains(const std::vector<RefinedView>& refined);

/// Contours with less than this of the refined ones' contrast do not lie on edges. On the synthetic recipes
/// masks that are exact have 0.89 to 1.03, those wrong by 2 px 0.36 to 0.66.
inline constexpr double kOffEdges = 0.75;
/// Whether the given masks' contours do not, on the mean of the views that were compared.
bool masks_misaligned(const std::vector<RefinedView>& refined);
/// Masks that err to one side have more than this share of what sets them apart from the refined ones on that side.
/// All too large or small by some pixels: 0.9 to 1; of a segmenter that rounds off: 0.4 to 0.5; displaced by chance: 0
/// to 0.25.
inline constexpr double kOneSided = 0.3;
bool masks_err_to_one_side(const std::vector<RefinedView>& refined);
/// How much better refined masks agree with the given ones than the rendered ones did: the normal score of the mean
/// gain over the views (problem/scene_measures.h). 0 where the given masks cannot tell: misaligned ones that err to one side. Errors
/// to both sides alike cancel in the mean over views.
double gain_by_masks(const std::vector<RefinedView>& refined);

/// Mean colour difference across the contour of the mask [H, W], between pixels three apart, summed over the channels;
/// 0 without a contour. `photo` is of the mask's size.
double contour_contrast(const std::vector<std::uint8_t>& mask, const ImageF& photo);

/// The refined masks of a view of the scene's size `w` x `h`, whole: nothing is there outside of the window.
ViewMasks whole_masks(const RefinedView& refined, int w, int h);

}  // namespace ngs
