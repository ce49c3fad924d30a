#pragma once
// ngs-joint --method saga: contrastive affinity features from given masks alone.            paper.md §6.4
//
// SAGA reduced to the part that needs no segmentation network. Every Gaussian has a feature. The loss pulls rendered
// features of pixels of one object together and pushes those of different ids apart. An object's prototype is the mean
// feature of its pixels in the view where the object has most pixels; the label is 1 if the cosine to the prototype
// exceeds a threshold. Pairs are formed within a view, so only an object with a prototype needs the same id in all
// views.
#include "ngs/options/field.h"
#include "ngs/problem/problem.h"

namespace ngs {

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
