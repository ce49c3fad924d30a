#pragma once
// What detectors measure a scene by. What several of them ask for is computed once, where the first asks. PAPER.md §5.7
//
// Masks and photos of training views and photos of others are read, masks of held-out views never. Everything is
// measured at the size it is given, on at most kDecisionViews views where that is enough.
#include <memory>
#include <optional>
#include <vector>

#include "ngs/ops/image/metrics.h"
#include "ngs/stages/optimise/training_options.h"
#include "ngs/problem/problem.h"
#include "ngs/scene/boundary_set.h"
#include "ngs/scene/knn_graph.h"

namespace ngs {

/// What the labels as they come look like in the training views that have masks.
struct LabelViews {
  std::vector<double> disagreement;  // of the model as it stands with the masks, 1 - IoU, summed over objects; per view
  std::vector<std::uint8_t> shown;   // per view, 1: mask or model shows an object
  double biou = 0;                   // mean over views and objects
  double outside = 0;  // share of the rendered object beyond a margin about its mask: the largest over the views
                       // whose mask is not empty; the others' pixels are all beyond
};

inline constexpr std::size_t kPhotoViews = 4;  // in which photos are compared with the model's pictures
inline constexpr std::size_t kVotingViews = 32;
inline constexpr std::size_t kFirstVotes = 8;
inline constexpr double kClearVote = 2.5;  // of at most 8 views, whose normal score is below 3.6

/// 1 - IoU; 0 where both masks are empty.
double disagreement(const Confusion& counts);

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
  std::vector<std::size_t> some_views() const;
  std::vector<Camera> some_cameras() const;
  /// Training views with a photo.
  double photos() const;

  /// Whether to stop: then what is measured means nothing.
  bool stopped() const;

  /// Of all training views; the sample: of at most 24, evenly spread.
  const LabelViews& label_views();
  const LabelViews& label_sample();
  /// How much better contours refined to the photos' edges agree with the masks than the contours of the labels do: a
  /// normal score over at most kVotingViews views, or over kFirstVotes views if that is below -kClearVote. 0 where the
  /// masks cannot tell: no photos, photos with edges that the model does not show
  /// (stages/contours/unexplained_contrast.h), or masks that all err to one side.
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
