#pragma once
// Input and output of every method of ngs-joint: the joint optimisation and the baselines (flash, sa3d, cob, saga, bce,
// released) run on the same inputs and the same rasteriser.
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
#include "ngs/scene/labels/label_column.h"
#include "ngs/scene/scene.h"

namespace ngs {

/// Minimum share of object evidence of a Gaussian that is partly an object's.
inline constexpr double kMinForegroundShare = 0.05;

/// Immutable label columns, one per object, shared by the problems of a run. With many objects they need more memory
/// than the model.
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

  /// Moves the labels out, leaving none here. Copies them only if another object shares them.
  std::vector<LabelColumns> release() {
    const std::shared_ptr<std::vector<LabelColumns>> labels = std::exchange(labels_, SharedLabels().labels_);
    return labels.use_count() == 1 ? std::move(*labels) : *labels;
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
  std::vector<std::size_t> views = {};                         // training views, as indices of scene.views
  std::function<ViewMasks(std::size_t view)> load_masks = {};  // at the camera's size
  std::function<ImageF(std::size_t view)> load_photo = {};     // [H, W, 3] at the camera's size; empty: no photo
  SplatOptions splat = {};
  Vec3<float> background{0, 0, 0};
  std::uint64_t seed = 0;
  std::vector<float> fixed = {};  // [N] ngs_fixed of a hand edit: 1 keeps the label; may be empty
  SharedLabels labels = {};       // written by ngs-variance, one per object
  BoundaryRule rule = {};         // the rule that computed the labels from their evidence
  std::shared_ptr<const std::vector<float>> weight = nullptr;  // [N] W of the labels' evidence; null: unknown
  // Like load_photo, at up to the photo's own size. Empty function or image: no photo.
  std::function<ImageF(std::size_t view)> load_fine_photo = {};
  std::vector<std::uint8_t> frozen = {};  // [N] 1: shape, opacity and colour must not change; empty: no row is frozen
  std::vector<std::uint8_t> region = {};  // [N] 0: no value of the row may change; empty: all rows may change
  std::vector<double> window_share = {};  // [views of the scene] share of its pixels inside the camera; empty: all 1
  std::shared_ptr<const Problem> uncropped = nullptr;  // the problem with uncropped views; null: this one is uncropped
  std::vector<std::shared_ptr<const void>> owns = {};  // objects behind the references above that need an owner
  Monitor* monitor = nullptr;                          // polled before every view for a stop request; null: none

  /// The problem with uncropped views.
  const Problem& whole() const { return uncropped ? *uncropped : *this; }

  // Copies of the problem with some members replaced.

  /// With another model and its labels; the weight becomes unknown.
  Problem with_model(std::shared_ptr<const GaussianCloud> cloud, std::vector<LabelColumns> labels) const;
  /// With the cameras of `scene`, which must outlive the copy, and masks and photos of their sizes.
  Problem with_views(const Scene& scene, std::function<ViewMasks(std::size_t)> load_masks,
                     std::function<ImageF(std::size_t)> load_photo) const;
  /// Like with_views(), for crops with the shares `window_share` of each view's pixels. The weight becomes unknown.
  Problem cropped(const Scene& scene, std::function<ViewMasks(std::size_t)> load_masks,
                  std::function<ImageF(std::size_t)> load_photo, std::vector<double> window_share) const;
};

/// Share of a view's pixels inside the problem's camera.
inline double window_share(const Problem& problem, std::size_t view) {
  return problem.window_share.empty() ? 1.0 : problem.window_share[view];
}

struct Solution {
  std::shared_ptr<const GaussianCloud> cloud;  // the input's cloud if it is unchanged; rows may be added or removed
  std::vector<std::int64_t> source_row = {};   // [rows] the input row of each row; empty: the same rows
  std::vector<LabelColumns> labels = {};       // one per object; label is the method's decision, prob its soft value
  std::map<std::string, double> figures = {};  // measurements by the method: steps, losses, gap, ...
  bool converged = true;                       // false: a budget ended the method early; the result is usable
};

/// Non-owning pointer for a Solution that does not change the model. `cloud` must outlive the solution.
inline std::shared_ptr<const GaussianCloud> unchanged(const GaussianCloud& cloud) {
  return {std::shared_ptr<const void>(), &cloud};
}

}  // namespace ngs
