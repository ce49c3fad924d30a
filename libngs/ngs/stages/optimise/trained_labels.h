#pragma once
// The labels of the joint steps: log-odds of those that are trained, and what is rendered of all.   PAPER.md §5.4
//
// Trained are cells (Gaussian, object): of a trained Gaussian the objects of whose region it is, or all where it is of
// none's. With many objects nearly all cells are nobody's, and would be most of the memory.
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

  /// From the problem's labels, `steps` EM steps from 1/2. What is never seen or fixed by hand is not trained; without
  /// a region all else is.
  void start(const Problem& input, int steps);
  /// [N, K] as they are rendered.
  Matrix<const float> rendered() const { return {label_.data(), gaussians_, int(objects_)}; }
  /// Adam step `t` from 1. `grad` [rows, K]: ∂L/∂(rendered).
  void step(const Exec& exec, double rate, std::int64_t t, const std::vector<float>& grad);
  /// To what is rendered, from what is trained.
  void put_back(const Exec& exec);
  /// Into the labels and probabilities of the result, one LabelColumns per object.
  void write(std::vector<LabelColumns>& columns) const;

  std::vector<float>& logit() { return logit_; }  // [cells]
  AdamMoments& moments() { return moments_; }

 private:
  std::size_t end_of_page(std::size_t row) const;
  /// f(cell, its place in [rows, K], its object) for those of trained row r.
  template <class F>
  void for_each_cell(std::size_t r, const F& f) const {
    for (std::size_t c = begin_[r]; c < begin_[r + 1]; ++c) f(c, r * objects_ + object_[c], std::size_t(object_[c]));
  }

  const TrainedRows& rows_;
  std::int64_t gaussians_ = 0;
  std::size_t objects_ = 0;
  std::vector<float> label_;           // [N, K]
  std::vector<std::size_t> begin_;     // [rows + 1] a row's first cell
  std::vector<std::uint32_t> object_;  // [cells]
  std::vector<float> logit_, grad_;    // [cells]
  AdamMoments moments_;
};

}  // namespace ngs
