#pragma once
// ngs-joint --method saga: contrastive affinity features from given masks alone.            paper.md §6.4
//
// SAGA reduced to the part that needs no segmentation network. Every Gaussian has a feature. The loss pulls rendered
// features of pixels of one object together and pushes those of different ids apart. An object's prototype is the mean
// feature of its pixels in the view where the object has most pixels; the label is 1 if the cosine to the prototype
// exceeds a threshold. Pairs are formed within a view, so only an object with a prototype needs the same id in all
// views.
#include <cmath>
#include <span>
#include <vector>

#include "ngs/backend/for_each.h"
#include "ngs/options/field.h"
#include "ngs/problem/problem.h"
#include "ngs/scene/knn_graph.h"

namespace ngs {

// Affinity features of the method saga: smoothing over neighbours, contrastive loss, and their gradients.
// paper.md §6.4
//
// T is float in production and double in gradient tests. The loss is always in double.

/// u_i = normalised Σ over the chosen neighbour slots s of F_j / |F_j|, j = graph.index[i, s].
template <class T>
class SmoothedFeatures {
 public:
  SmoothedFeatures(const KnnGraph& graph, int dims) : graph_(graph), dims_(dims) {}

  /// `features` [N, D]; `slot_used` [K]. Writes u [N, D].
  void forward(const Exec& exec, const std::vector<T>& features, const std::vector<std::uint8_t>& slot_used,
               std::vector<T>& u) {
    const auto d = std::size_t(dims_);
    unit_.resize(features.size());
    sum_.resize(features.size());
    u.resize(features.size());
    for_each_index(exec, graph_.points,
                   [&](std::int64_t i) { normalise(&features[std::size_t(i) * d], &unit_[std::size_t(i) * d]); });
    for_each_index(exec, graph_.points, [&](std::int64_t i) {
      T* sum = &sum_[std::size_t(i) * d];
      std::fill_n(sum, dims_, T(0));
      for (int s = 0; s < graph_.neighbours; ++s) {
        if (!slot_used[std::size_t(s)]) continue;
        const T* from = &unit_[graph_.index[std::size_t(i * graph_.neighbours + s)] * d];
        for (int c = 0; c < dims_; ++c) sum[c] += from[c];
      }
      normalise(sum, &u[std::size_t(i) * d]);
    });
    used_ = slot_used;
  }

  /// Overwrites `grad_features` from ∂L/∂u. `features` and `u` are the input and output of the last forward().
  void backward(const Exec& exec, const std::vector<T>& features, const std::vector<T>& u, const std::vector<T>& grad_u,
                std::vector<T>& grad_features) {
    const auto d = std::size_t(dims_);
    grad_sum_.resize(u.size());
    grad_features.resize(u.size());
    for_each_index(exec, graph_.points, [&](std::int64_t i) {
      const std::size_t at = std::size_t(i) * d;
      normalise_backward(&sum_[at], &u[at], &grad_u[at], &grad_sum_[at]);
    });
    for_each_index(exec, graph_.points, [&](std::int64_t j) {
      std::vector<T> grad_unit(d, T(0));
      for (std::int64_t e = graph_.row_begin[std::size_t(j)]; e < graph_.row_begin[std::size_t(j) + 1]; ++e) {
        const std::int64_t edge = graph_.edge[std::size_t(e)];
        if (!used_[std::size_t(edge % graph_.neighbours)]) continue;
        const T* g = &grad_sum_[std::size_t(edge / graph_.neighbours) * d];
        for (std::size_t c = 0; c < d; ++c) grad_unit[c] += g[c];
      }
      const std::size_t at = std::size_t(j) * d;
      normalise_backward(&features[at], &unit_[at], grad_unit.data(), &grad_features[at]);
    });
  }

 private:
  T length(const T* v) const {
    T square = T(0);
    for (int c = 0; c < dims_; ++c) square += v[c] * v[c];
    return std::sqrt(square);
  }
  void normalise(const T* v, T* out) const {  // a zero vector stays zero
    const T l = length(v);
    for (int c = 0; c < dims_; ++c) out[c] = l > T(0) ? v[c] / l : T(0);
  }
  void normalise_backward(const T* v, const T* unit, const T* grad_unit, T* grad) const {
    const T l = length(v);
    T along = T(0);
    for (int c = 0; c < dims_; ++c) along += grad_unit[c] * unit[c];
    for (int c = 0; c < dims_; ++c) grad[c] = l > T(0) ? (grad_unit[c] - along * unit[c]) / l : T(0);
  }

  const KnnGraph& graph_;
  int dims_;
  std::vector<std::uint8_t> used_;
  std::vector<T> unit_, sum_, grad_sum_;
};

/// Loss over all pairs of S rendered pixel features P [S, D] with cos = P_i · P_j / (|P_i| |P_j|):
///   L = -mean cos over pairs of one object + mean max(0, cos) over pairs of different ids + (1 - mean |P|)²
/// id 0 is background: pairs of an object and background count as different, pairs of two background pixels are
/// ignored. Features shorter than 1e-3 (hardly covered pixels) enter the last term only. Overwrites `grad` [S, D].
double contrastive_loss(const Exec& exec, int dims, std::span<const float> features, std::span<const int> id,
                        std::vector<float>& grad);

struct SagaOptions {
  int dims = 32, steps = 300;
  double threshold = 0.75;
  // No option sets these.
  int pixels = 512;          // compared per step
  double lr = 0.005;         // Adam (the published code: 0.0025 with 10000 steps)
  double image_scale = 0.5;  // size of the feature images

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.dims, Field<int>{"saga_dims", "", "Length of a Gaussian's feature", 2, 64});
    visit(self.steps, Field<int>{"saga_steps", "", "Optimisation steps, one view each", 1, 1000000});
    visit(self.threshold,
          Field<double>{"saga_threshold", "", "Label 1 if the cosine to the prototype exceeds this", -1.0, 1.0});
  }
};

Solution run_saga(const Exec& exec, Monitor& monitor, const SagaOptions& options, const Problem& input);

}  // namespace ngs
