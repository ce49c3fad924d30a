#pragma once
// Quantities that heuristics measure on a scene. Shared quantities are computed at their first use and cached.
//                                                                                                        paper.md §5.7
// The probe reads photos of all views and masks of the training views. It never reads masks of held-out views.
// Quantities are measured at the size of the given problem. Some of them use at most kDecisionViews views.
#include <memory>
#include <optional>
#include <vector>

#include "ngs/cut/training/training_options.h"
#include "ngs/ops/image/metrics.h"
#include "ngs/problem/problem.h"
#include "ngs/scene/boundary_set.h"
#include "ngs/scene/knn_graph.h"

namespace ngs {

/// Comparison of the closed-form labels, rendered into the training views that have masks, with these masks.
struct LabelViews {
  std::vector<double> disagreement;  // per view: 1 - IoU of the rendered model and the masks, summed over the objects
  std::vector<std::uint8_t> shown;   // per view, 1: mask or model shows an object
  double biou = 0;                   // mean boundary IoU over views and objects
  double outside = 0;  // share of the rendered object outside the mask's box plus a margin; maximum over the views with
                       // a mask that is not empty
};

inline constexpr std::size_t kPhotoViews = 4;  // views in which photos are compared with renderings
inline constexpr std::size_t kComparedViews = 32;
inline constexpr std::size_t kFirstComparedViews = 8;
/// Of kFirstComparedViews views, whose normal score has a magnitude below 3.6.
inline constexpr double kClearScore = 2.5;

/// 1 - IoU; 0 where both masks are empty.
double disagreement(const Confusion& counts);

/// Why a threshold on a difference of colours is 0.5 levels.
inline constexpr std::string_view kHalfLevel = "half a level: an 8-bit photo cannot show less";

class SceneProbe {
 public:
  SceneProbe(const Exec& exec, const TrainingOptions& training, const Problem& problem)
      : exec_(exec), training_(training), problem_(problem) {}
  SceneProbe(const SceneProbe&) = delete;
  SceneProbe& operator=(const SceneProbe&) = delete;

  const Exec& exec() const { return exec_; }
  const TrainingOptions& training() const { return training_; }
  const Problem& problem() const { return problem_; }

  /// At most kDecisionViews training views, evenly spread.
  std::vector<std::size_t> sample_views() const;
  std::vector<Camera> sample_cameras() const;
  double views_with_photo() const;

  /// True: a stop was requested, and measured values are invalid.
  bool stopped() const;

  /// label_views() covers all training views; label_sample() covers at most 24, evenly spread.
  const LabelViews& label_views();
  const LabelViews& label_sample();
  /// Gain in agreement with the masks from refining the label contours to the photos' edges, as a normal score. It uses
  /// at most kComparedViews views, or only kFirstComparedViews views if their score is below -kClearScore. It is 0 if
  /// the masks are no evidence: without photos, if the photos have edges that the model does not show
  /// (cut/contours/unexplained_contrast.h), or if all masks err to one side.
  double edge_gain();
  const BoundarySet& boundary();
  Rows<const float, 3> boundary_colours();
  const KnnGraph& boundary_neighbours();

 private:
  const Exec exec_;
  const TrainingOptions& training_;
  const Problem& problem_;
  LabelViews label_views_of(const std::vector<std::size_t>& views);

  std::optional<LabelViews> views_, sample_;
  std::optional<double> edge_gain_;
  std::optional<BoundarySet> boundary_;
  std::optional<KnnGraph> neighbours_;
};

}  // namespace ngs
