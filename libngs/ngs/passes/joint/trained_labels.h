#pragma once
// The labels of the joint steps: log-odds of the Gaussians that are trained, and what is rendered of them.
//                                                                                               PAPER.md §5.4
#include <vector>

#include "ngs/ops/optim/adam.h"
#include "ngs/problem/problem.h"
#include "ngs/problem/trained_rows.h"
#include "ngs/scene/views.h"

namespace ngs {

class TrainedLabels {
 public:
  /// `rows` must outlive it.
  explicit TrainedLabels(const TrainedRows& rows) : rows_(rows) {}

  /// From the problem's labels, `steps` EM steps from 1/2.
  void start(const Problem& input, int steps);
  /// [N, K] as they are rendered.
  Matrix<const float> rendered() const { return {label_.data(), gaussians_, int(objects_)}; }
  /// ∂L/∂(rendered) [rows, K] becomes ∂L/∂(log-odds): 0 where a label is not trained.
  void to_logits(std::vector<float>& grad) const;
  /// Adam step `t` from 1. `grad` [rows, K] of the log-odds.
  void step(const Exec& exec, double rate, std::int64_t t, const std::vector<float>& grad);
  /// To what is rendered, from what is trained.
  void put_back(const Exec& exec);
  /// Into the labels and probabilities of the result, one LabelColumns per object.
  void write(std::vector<LabelColumns>& columns) const;

  std::vector<float>& logit() { return logit_; }  // [rows, K]
  AdamMoments& moments() { return moments_; }

 private:
  std::size_t end_of_page(std::size_t row) const;

  const TrainedRows& rows_;
  std::int64_t gaussians_ = 0;
  std::size_t objects_ = 0;
  std::vector<float> label_, logit_;     // [N, K], [rows, K]
  std::vector<std::uint8_t> trainable_;  // [rows, K] seen and not fixed by hand
  AdamMoments moments_;
};

}  // namespace ngs
