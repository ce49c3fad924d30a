#pragma once
// The labels of the joint steps: log-odds of the trained labels, and rendered values of all labels.  paper.md §5.4
//
// A trained label is a cell (Gaussian, object). A trained Gaussian has a cell for each object whose region contains it,
// or for all objects if no region does. With many objects, storing all cells would need most of the memory.
#include <algorithm>
#include <vector>

#include "ngs/math/stable.h"
#include "ngs/ops/optim/adam.h"
#include "ngs/problem/problem.h"
#include "ngs/problem/trained_rows.h"
#include "ngs/scene/views.h"

namespace ngs {

// Start values of the soft labels of the joint steps (paper.md §5.4).

inline constexpr double kMaxInitialConfidence = 0.99;  // bound on start labels, so that the sigmoid has a gradient

/// Log-odds after `steps` EM steps on the mask loss (§5.3) from labels of 1/2. The first step gives the share f of the
/// evidence. If the rendered mask is about f near the Gaussian, every further step adds ln(f / (1 - f)).
inline double start_log_odds(double share, int steps) {
  const double most = logit(kMaxInitialConfidence);
  return std::clamp(steps * logit(std::clamp(share, 1 - kMaxInitialConfidence, kMaxInitialConfidence)), -most, most);
}

class TrainedLabels {
 public:
  /// `rows` must outlive this object.
  explicit TrainedLabels(const TrainedRows& rows) : rows_(rows) {}

  /// Sets the labels to the problem's, after `steps` EM steps from 1/2. Labels of unseen Gaussians and labels fixed by
  /// hand are not trained. Without a region all others are.
  void start(const Problem& input, int steps);
  /// [N, K] the rendered labels.
  Matrix<const float> rendered() const { return {label_.data(), gaussians_, int(objects_)}; }
  /// Takes the gradients of the trained labels from `grad` [rows, K], ∂L/∂(rendered); for adam_step().
  AdamGroup group(const Exec& exec, double rate, const std::vector<float>& grad);
  /// Copies the trained labels to the rendered ones.
  void write_back(const Exec& exec);
  /// Writes label and prob of the result, one LabelColumns per object.
  void write(std::vector<LabelColumns>& columns) const;

  std::vector<float>& logit() { return logit_; }  // [cells]
  AdamMoments& moments() { return moments_; }
  void add_to(Resident& resident);

 private:
  LabelCells cells() const { return {begin_.data(), object_.data(), logit_.data(), objects_, logit_.size()}; }
  std::size_t end_of_page(std::size_t row) const;

  const TrainedRows& rows_;
  std::int64_t gaussians_ = 0;
  std::size_t objects_ = 0;
  std::vector<float> label_;           // [N, K]
  std::vector<std::size_t> begin_;     // [rows + 1] first cell of a row
  std::vector<std::uint32_t> object_;  // [cells]
  std::vector<float> logit_, grad_;    // [cells]
  AdamMoments moments_;
};

}  // namespace ngs
