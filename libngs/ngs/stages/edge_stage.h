#pragma once
// After the joint optimisation: contours moved to the edges of the photos, and a model that follows them.
//                                                                     beyond the paper, where its step 6
//                                                                     ends; PAPER.md §5.10
// In every round the labels are rendered at every photo, also at those that have no mask; each rendered mask
// is walked to the photo's edges (ops/edge_walk.h); Gaussians that lie across a contour are halved; and
// labels and Gaussians are trained on the walked masks and the photos, in a window about the object. No mask
// of a held-out view is read: such a view contributes its photo alone, as it did when the model was trained.
//
// The walk has to earn its place: where the walked masks of the training views agree significantly less with
// the views' own masks than the rendered ones did, the photos' edges are not the object's, and the model
// stays as it was. Unless the own masks' contours lie beside the edges: the photos show far less contrast
// across them than across the walked ones. Then they are too inaccurate to judge (all of them too small,
// say).
#include "ngs/ops/edge_walk.h"
#include "ngs/stages/joint_stage.h"

namespace ngs {

enum class EdgeViews : std::uint8_t { kAll, kTrain };
inline constexpr NamedValue<EdgeViews> kEdgeViewsNames[] = {{EdgeViews::kAll, "all"},
                                                            {EdgeViews::kTrain, "train"}};

/// What a view without a photo is trained on: nothing, the model's own picture of it, or what serves other views better.
enum class EdgeUnseen : std::uint8_t { kAuto, kLeave, kPicture };
inline constexpr NamedValue<EdgeUnseen> kEdgeUnseenNames[] = {
    {EdgeUnseen::kAuto, "auto"}, {EdgeUnseen::kLeave, "leave"}, {EdgeUnseen::kPicture, "picture"}};

struct EdgeOptions {
  int rounds = 0, visits = 0;  // 0: edge_rounds(), edge_visits()
  EdgeViews views = EdgeViews::kAll;
  EdgeUnseen unseen = EdgeUnseen::kAuto;
  EdgeWalkOptions walk;
  double split_px = 3, margin_px = 64, rate = 1;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.rounds,
          Field<int>{"edge_rounds", "",
                     "edges: rounds of masks walked to the photos' edges; 0: 2, and 3 where the masks' contours lie beside them; "
                     "high 2 more, reference 5 more",
                     0, 100});
    visit(self.visits,
          Field<int>{"edge_visits", "",
                     "edges: steps per view and round, half as many in rounds at half the size; 0: 15, fewer "
                     "of many views",
                     0, 1'000'000});
    visit(self.views,
          Choice<EdgeViews>{"edge_views", "edges: whose photos are used; no held-out mask ever is",
                            kEdgeViewsNames});
    visit(self.unseen,
          Choice<EdgeUnseen>{"edge_unseen",
                             "edges: views without a photo follow the edges of the model's own picture, or are left; auto: what is "
                             "nearer to the photos in views that have one",
                             kEdgeUnseenNames});
    visit(self.walk.band_px, Field<double>{"edge_band", "px of the photo",
                                           "edges: how far a contour may move in a round", 0.5, 1e3});
    visit(self.walk.reach_px,
          Field<double>{"edge_reach", "px of the photo",
                        "edges: colours are learned from pixels this near the contour", 4, 1e4});
    visit(self.walk.colour_weight,
          Field<double>{"edge_colour", "", "edges: weight of the local colours", 0, 1e3});
    visit(self.walk.shape_weight,
          Field<double>{"edge_shape", "", "edges: weight of the contour as rendered", 1e-6, 1e3});
    visit(self.walk.doubt_weight,
          Field<double>{"edge_doubt", "", "edges: more weight of it where colours do not tell the sides", 0, 1e6});
    visit(self.split_px, Field<double>{"edge_split", "px",
                                       "edges: halve Gaussians with more weight across contours", 0, 1e9});
    visit(self.margin_px, Field<double>{"edge_margin", "px", "edges: margin of the trained window", 1, 1e5});
    visit(self.rate, Field<double>{"edge_rate", "", "edges: factor on the rates of the Gaussians", 0, 1e3});
  }
};

struct EdgeSetup {
  const EdgeOptions& edge;
  const JointOptions& joint;
  const SampleOptions& sample;
  const RbfOptions& rbf;
  const MethodInput& input;
  // Asked after every step, of the trainer on the windows, whose plan it may change, and of the whole model as it is
  // then; true ends the stage. May be empty.
  std::function<bool(const JointProgress&, JointTrainer&, const std::function<MethodResult()>& whole)> stop_after = {};
  // Told how many rounds the first walk asks for; returns how many there is time for, 0: none, then
  // the model stays as it is. May be empty.
  std::function<int(int rounds)> rounds_allowed = {};
};

/// Of more views than this the default takes each less often: steps grow with the root of the views.
inline constexpr int kEdgeViewsOfAllVisits = 21;

/// Rounds where the masks' contours lie on the photos' edges, or beside them: then what the first rounds correct is more
/// than a walk's reach. Higher qualities have more rounds, which gain more than more visits in them do.
inline int edge_rounds(const EdgeOptions& edge, Quality quality, bool beside) {
  const int more = quality == Quality::kReference ? 5 : quality == Quality::kHigh ? 2 : 0;
  return edge.rounds > 0 ? edge.rounds : (beside ? 3 : 2) + more;
}

/// Of `visits` in the last round, how many a round before it takes where it is trained at half the size.
int early_visits(int visits);
/// What the steps of a round before the last take of the time of those of the last (BENCHMARKS.md).
double early_round_share(const JointEffects& effects, int visits);

/// Whether a trial on views without a photo may come before the rounds, and take the time of one more.
bool may_try_pictures(const EdgeOptions& edge, const Scene& scene);

/// Steps per view and round where there are `views` of them; 0: the stage does nothing.
int edge_visits(const EdgeOptions& edge, Quality quality, std::size_t views);

/// Goes on from the result of a method; `start` comes back where no view has a photo, where nothing is
/// labelled, for
/// --quality draft, or where the walk does not agree with the masks. Figures: edge_rounds (done),
/// edge_gaussians (rows afterwards), edge_biou_rendered and edge_biou_walked: mean boundary IoU (0.005) with
/// the training views' own masks before the first round; edge_contrast_given and edge_contrast_walked: mean
/// colour difference of the photos across the contours; edge_detail: 2 where photos with fewer pixels were walked at
/// twice the camera's size, else 1; edge_pictures: views trained on the model's own picture; where these were tried on other
/// views, edge_biou_pictured and edge_biou_unseen (stages/edge_unseen.h). Not converged if it ran out of time.
MethodResult follow_edges(const Exec& exec, Monitor& monitor, const EdgeSetup& setup, MethodResult start);

}  // namespace ngs
