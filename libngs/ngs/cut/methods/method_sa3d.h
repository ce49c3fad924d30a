#pragma once
// ngs-joint --method sa3d: mask inverse rendering of SA3D-GS in closed form.               paper.md §6.2
//
// The loss of SA3D-GS, -Σ G M + λ Σ (1 - G) M per view, is linear in the labels: the label of a Gaussian is 1 if its
// share f = A1 / (A0 + A1) exceeds λ / (1 + λ). Views are processed in order. A view other than the first is skipped
// if the IoU of its mask with the rendered current labels is below the gate. Between passes all Gaussians outside the
// object are removed, so that later passes reach object Gaussians that were occluded.
#include "ngs/options/field.h"
#include "ngs/problem/problem.h"

namespace ngs {

struct Sa3dOptions {
  double lambda = 0.3;
  double gate_iou = 0.5;
  int passes = 2;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.lambda, Field<double>{"sa3d_lambda", "", "Weight of pixels outside the mask", 1e-6, 1e6});
    visit(self.gate_iou,
          Field<double>{"sa3d_gate_iou", "", "Skip views whose IoU with the current labels is below this", 0.0, 1.0});
    visit(self.passes, Field<int>{"sa3d_passes", "", "Number of passes over the views", 1, 100});
  }
};

Solution run_sa3d(const Exec& exec, Monitor& monitor, const Sa3dOptions& options, const Problem& input);

}  // namespace ngs
