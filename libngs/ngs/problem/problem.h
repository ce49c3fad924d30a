#pragma once
// What every method of ngs-joint takes and gives back: the paper's joint optimisation and the methods beside it
// (flash, sa3d, cob, saga, bce, released) run on the same inputs through the same splat core.
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ngs/core/monitor.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/scene/evidence.h"
#include "ngs/scene/labels/boundary_rule.h"
#include "ngs/scene/labels/label_columns.h"
#include "ngs/scene/scene.h"

namespace ngs {

/// Share of the masks' evidence from which on a Gaussian counts as partly an object's.
inline constexpr double kLeastForegroundShare = 0.05;

/// Labels, one per object, that nobody changes: the inputs of one run's stages share them. With many objects they take
/// more memory than the model.
class SharedLabels {
 public:
  SharedLabels() : SharedLabels(std::vector<LabelColumns>()) {}
  SharedLabels(std::vector<LabelColumns> labels)
      : labels_(std::make_shared<std::vector<LabelColumns>>(std::move(labels))) {}
  operator const std::vector<LabelColumns>&() const { return *labels_; }
  bool empty() const { return labels_->empty(); }
  std::size_t size() const { return labels_->size(); }
  const LabelColumns& operator[](std::size_t object) const { return (*labels_)[object]; }
  auto begin() const { return labels_->cbegin(); }
  auto end() const { return labels_->cend(); }

  /// To be changed, without a second copy where nobody else has them; there are none here then.
  std::vector<LabelColumns> taken() {
    const std::shared_ptr<std::vector<LabelColumns>> mine = std::exchange(labels_, SharedLabels().labels_);
    return mine.use_count() == 1 ? std::move(*mine) : *mine;
  }

 private:
  std::shared_ptr<std::vector<LabelColumns>> labels_;
};

struct LabelledModel {
  const GaussianCloud& cloud;
  const std::vector<LabelColumns>& labels;  // one per object
};

struct Problem {
  const GaussianCloud& cloud;
  const Scene& scene;
  std::vector<std::size_t> views;                         // indices of scene.views that may supervise
  std::function<ViewMasks(std::size_t view)> load_masks;  // at the camera's size
  std::function<ImageF(std::size_t view)> load_photo;     // [H, W, 3] at the camera's size; empty: no photo
  SplatOptions splat;
  Vec3<float> background{0, 0, 0};
  std::uint64_t seed = 0;
  std::vector<float> fixed;  // [N] ngs_fixed of a hand edit: 1 keeps its label; may be empty
  SharedLabels labels;       // of ngs-variance, one per object
  BoundaryRule rule = {};    // by which the labels follow from their evidence
  std::shared_ptr<const std::vector<float>> weight = nullptr;  // [N] W of the evidence that they follow from; null: not
                                                               // known, nor in a window
  // As load_photo, finer where the photo has more pixels than the camera; empty function or image: no photo.
  std::function<ImageF(std::size_t view)> load_fine_photo = {};
  std::vector<std::uint8_t> frozen = {};    // [N] 1: shape, opacity and colour stay as they are; empty: none
  std::vector<std::uint8_t> region = {};  // [N] 0: nothing of the row may change; empty: all may
  std::vector<double> window_share = {};  // [views of the scene] of its pixels that the camera shows; empty: all
  std::shared_ptr<const Problem> whole = nullptr;      // the same in whole views; null: this one is
  std::vector<std::shared_ptr<const void>> owns = {};  // what the references above refer to, where nobody else keeps it
  Monitor* monitor = nullptr;                          // asked before every view whether to go on; null: goes on

  // The same problem, all members included, but for what is said.

  /// Of another model, with its labels; their evidence is not known.
  Problem with_model(std::shared_ptr<const GaussianCloud> cloud, std::vector<LabelColumns> labels) const;
  /// Seen by the cameras of `scene`, which must outlive it, with masks and photos of their size.
  Problem with_views(const Scene& scene, std::function<ViewMasks(std::size_t)> load_masks,
                     std::function<ImageF(std::size_t)> load_photo) const;
  /// As with_views(), of a part of every view: `window_share` of its pixels. The evidence of a part is not known.
  Problem cropped(const Scene& scene, std::function<ViewMasks(std::size_t)> load_masks,
                  std::function<ImageF(std::size_t)> load_photo, std::vector<double> window_share) const;
};

/// Share of a view's pixels that the camera of the problem shows.
inline double window_share(const Problem& problem, std::size_t view) {
  return problem.window_share.empty() ? 1.0 : problem.window_share[view];
}

struct Solution {
  std::shared_ptr<const GaussianCloud> cloud;  // the input's own where it is as it was; rows may be added or removed
  std::vector<std::int64_t> source_row;        // [rows] input row each row descends from; empty: unchanged rows
  std::vector<LabelColumns> labels;            // one per object; label is the method's decision, prob its soft value
  std::map<std::string, double> figures;       // what the method has to say about itself: steps, losses, gap, ...
  bool converged = true;                       // false: a budget ended it early with a usable result
};

/// The model of a Solution that leaves it as it is. It must outlive the solution: no copy is made.
inline std::shared_ptr<const GaussianCloud> unchanged(const GaussianCloud& cloud) {
  return {std::shared_ptr<const void>(), &cloud};
}

}  // namespace ngs
