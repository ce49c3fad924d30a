#pragma once
// After the joint optimisation: contours moved to the edges of the photos, and a model that follows them.
//                                                                     beyond the paper, where its step 6
//                                                                     ends; PAPER.md §5.10
// In every iteration the labels are rendered at every photo, also at those that have no mask; each rendered mask
// is refined to the photo's edges (ops/image/contour_refine.h); Gaussians that lie across a contour are halved; and
// labels and Gaussians are trained on the refined masks and the photos, in a window about the object. No mask
// of a held-out view is read: such a view contributes its photo alone, as it did when the model was trained.
//
// The walk has to earn its place: where the refined masks of the training views agree significantly less with
// the views' own masks than the rendered ones did, the photos' edges are not the object's, and the model
// stays as it was. Unless the own masks' contours lie beside the edges: the photos show far less contrast
// across them than across the refined ones. Then they are too inaccurate to judge (all of them too small,
// say).
#include "ngs/ops/image/contour_refine.h"
#include "ngs/passes/joint/joint_stage.h"

namespace ngs {

enum class ContourViews : std::uint8_t { kAll, kTrain };
inline constexpr NamedValue<ContourViews> kContourViewsNames[] = {{ContourViews::kAll, "all"},
                                                            {ContourViews::kTrain, "train"}};

/// What a view without a photo is trained on: nothing, the model's own picture of it, or what serves other views better.
enum class PhotolessViews : std::uint8_t { kAuto, kLeave, kPicture };
inline constexpr NamedValue<PhotolessViews> kPhotolessViewsNames[] = {
    {PhotolessViews::kAuto, "auto"}, {PhotolessViews::kLeave, "leave"}, {PhotolessViews::kPicture, "picture"}};

struct ContourOptions {
  int iterations = 0, epochs = 0;  // 0: contour_iterations(), contour_epochs()
  ContourViews views = ContourViews::kAll;
  PhotolessViews unseen = PhotolessViews::kAuto;
  ContourRefineOptions walk;
  double split_px = 3, margin_px = 64, rate = 1;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.iterations,
          Field<int>{"contour_iterations", "",
                     "edges: iterations of masks refined to the photos' edges; 0: 2, and 3 where the masks' contours lie beside them; "
                     "high 2 more, reference 5 more",
                     0, 100});
    visit(self.epochs,
          Field<int>{"contour_epochs", "",
                     "edges: steps per view and iteration, half as many in iterations at half the size; 0: 15, fewer "
                     "of many views",
                     0, 1'000'000});
    visit(self.views,
          Choice<ContourViews>{"contour_views", "edges: whose photos are used; no held-out mask ever is",
                            kContourViewsNames});
    visit(self.unseen,
          Choice<PhotolessViews>{"contour_photoless",
                             "edges: views without a photo follow the edges of the model's own picture, or are left; auto: what is "
                             "nearer to the photos in views that have one",
                             kPhotolessViewsNames});
    visit(self.walk.band_px, Field<double>{"contour_band", "px of the photo",
                                           "edges: how far a contour may move in an iteration", 0.5, 1e3});
    visit(self.walk.reach_px,
          Field<double>{"contour_reach", "px of the photo",
                        "edges: colours are learned from pixels this near the contour", 4, 1e4});
    visit(self.walk.colour_weight,
          Field<double>{"contour_colour", "", "edges: weight of the local colours", 0, 1e3});
    visit(self.walk.shape_weight,
          Field<double>{"contour_shape", "", "edges: weight of the contour as rendered", 1e-6, 1e3});
    visit(self.walk.doubt_weight,
          Field<double>{"contour_ambiguity", "", "edges: more weight of it where colours do not tell the sides", 0, 1e6});
    visit(self.split_px, Field<double>{"contour_split", "px",
                                       "edges: halve Gaussians with more weight across contours", 0, 1e9});
    visit(self.margin_px, Field<double>{"contour_margin", "px", "edges: margin of the trained window", 1, 1e5});
    visit(self.rate, Field<double>{"contour_rate", "", "edges: factor on the rates of the Gaussians", 0, 1e3});
  }
};

struct ContourSetup {
  const ContourOptions& edge;
  const JointOptions& joint;
  const SampleOptions& sample;
  const RbfOptions& rbf;
  const Problem& input;
  // Asked after every step, of the trainer on the windows, whose plan it may change, and of the whole model as it is
  // then; true ends the stage. May be empty.
  std::function<bool(const JointProgress&, JointTrainer&, const std::function<Solution()>& whole)> stop_after = {};
  // Told how many iterations the first walk asks for; returns how many there is time for, 0: none, then
  // the model stays as it is. May be empty.
  std::function<int(int iterations)> iterations_allowed = {};
};

/// Of more views than this the default takes each less often: steps grow with the root of the views.
inline constexpr int kViewsOfAllEpochs = 21;

/// Rounds where the masks' contours lie on the photos' edges, or beside them: then what the first iterations correct is more
/// than a walk's reach. Higher qualities have more iterations, which gain more than more epochs in them do.
inline int contour_iterations(const ContourOptions& edge, Quality quality, bool beside) {
  const int more = quality == Quality::kReference ? 5 : quality == Quality::kHigh ? 2 : 0;
  return edge.iterations > 0 ? edge.iterations : (beside ? 3 : 2) + more;
}

/// Of `epochs` in the last iteration, how many an iteration before it takes where it is trained at half the size.
int early_epochs(int epochs);
/// What the steps of an iteration before the last take of the time of those of the last (BENCHMARKS.md).
double early_iteration_share(const JointEffects& effects, int epochs);

/// Whether a trial on views without a photo may come before the iterations, and take the time of one more.
bool may_try_pictures(const ContourOptions& edge, const Scene& scene);

/// Steps per view and iteration where there are `views` of them; 0: the stage does nothing.
int contour_epochs(const ContourOptions& edge, Quality quality, std::size_t views);

/// Goes on from the result of a method; `start` comes back where no view has a photo, where nothing is
/// labelled, for
/// --quality draft, or where the walk does not agree with the masks. Figures: contour_iterations (done),
/// contour_gaussians (rows afterwards), contour_biou_rendered and contour_biou_refined: mean boundary IoU (0.005) with
/// the training views' own masks before the first iteration; contour_contrast_given and contour_contrast_refined: mean
/// colour difference of the photos across the contours; contour_detail: 2 where photos with fewer pixels were refined at
/// twice the camera's size, else 1; contour_pictures: views trained on the model's own picture; where these were tried on other
/// views, contour_biou_pictured and contour_biou_skipped (passes/contours/photoless_views.h). Not converged if it ran out of time.
Solution refine_contours(const Exec& exec, Monitor& monitor, const ContourSetup& setup, Solution start);

}  // namespace ngs
