#pragma once
// ngs-joint --method saga: contrastive affinity features from given masks alone.            PAPER.md §6.4
//
// The reduction of SAGA that needs no segmentation network: every Gaussian carries a feature; rendered
// features of one object's pixels attract each other, those of different ids repel. An object's prototype is
// the mean feature of its pixels in a reference view; label 1 where the cosine to it exceeds a threshold.
// Object ids need to agree between views only for the prototype's own object, since pairs are formed within a
// view.
#include <string>

#include "ngs/options/field.h"
#include "ngs/problem/problem.h"

namespace ngs {

struct SagaOptions {
  int dims = 32, steps = 300, pixels = 512, neighbours = 16;
  double lr = 0.005, image_scale = 0.5, threshold = 0.75;
  std::string reference;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.dims, Field<int>{"saga_dims", "", "length of a Gaussian's feature", 2, 64});
    visit(self.steps, Field<int>{"saga_steps", "", "optimisation steps, one view each", 1, 1000000});
    visit(self.pixels, Field<int>{"saga_pixels", "", "pixels that a step compares", 2, 8192});
    visit(self.neighbours, Field<int>{"saga_neighbours", "", "Gaussians that a feature is averaged over", 1, 32});
    visit(self.lr, Field<double>{"saga_lr", "", "Adam rate (0.0025 in the code, which takes 10000 steps)", 1e-6, 10.0});
    visit(self.image_scale, Field<double>{"saga_image_scale", "", "size of the feature images", 1e-2, 4.0});
    visit(self.threshold,
          Field<double>{"saga_threshold", "", "label 1 where the cosine to the prototype exceeds this", -1.0, 1.0});
    visit(self.reference,
          Text{"saga_reference", "VIEW", "view of the prototypes; default: where the object is largest"});
  }
};

Solution run_saga(const Exec& exec, Monitor& monitor, const SagaOptions& options, const Problem& input);

}  // namespace ngs
