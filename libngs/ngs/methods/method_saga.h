#pragma once
// ngs-joint --method saga: contrastive affinity features from given masks alone.            PAPER.md §6.4
//
// The reduction of SAGA that needs no segmentation network: every Gaussian carries a feature; rendered
// features of one object's pixels attract each other, those of different ids repel. An object's prototype is
// the mean feature of its pixels in the view where the object is largest; label 1 where the cosine to it exceeds a
// threshold. Object ids need to agree between views only for the prototype's own object, since pairs are formed within
// a view.
#include "ngs/options/field.h"
#include "ngs/problem/problem.h"

namespace ngs {

struct SagaOptions {
  int dims = 32, steps = 300;
  double threshold = 0.75;
  // No flag sets these.
  int pixels = 512;          // that a step compares
  double lr = 0.005;         // Adam (0.0025 in the code, which takes 10000 steps)
  double image_scale = 0.5;  // size of the feature images

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.dims, Field<int>{"saga_dims", "", "length of a Gaussian's feature", 2, 64});
    visit(self.steps, Field<int>{"saga_steps", "", "optimisation steps, one view each", 1, 1000000});
    visit(self.threshold,
          Field<double>{"saga_threshold", "", "label 1 where the cosine to the prototype exceeds this", -1.0, 1.0});
  }
};

Solution run_saga(const Exec& exec, Monitor& monitor, const SagaOptions& options, const Problem& input);

}  // namespace ngs
