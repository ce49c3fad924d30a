#pragma once
// Options of the methods cob (cut/methods/method_cob.h) and released (cut/methods/method_released.h).
#include "ngs/options/field.h"

namespace ngs {

/// Number of views that the sum of r is divided by: views in which the Gaussian is visible, or all views as in the
/// published code.
enum class CobDivisor : std::uint8_t { kVisible, kAll };

struct CobOptions {
  int rounds = 2;
  double lambda = 1, ambiguity = 0.5;
  // Values of the published code; no option sets them.
  CobDivisor divisor = CobDivisor::kVisible;
  double split_scale = 0.01;  // fraction of the extent: only larger Gaussians are split
  double position_lr = 1.6e-6, dc_lr = 0.0025, rest_lr = 0.000125, opacity_lr = 0.025, scale_lr = 0.005,
         rotation_lr = 0.001;  // Adam rates of the texture phases; the position's is per unit of the extent

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.rounds,
          Field<int>{"cob_rounds", "", "Pairs of mask and texture phases before the last mask phase; 0: labels only", 0,
                     1000});
    visit(self.lambda, Field<double>{"cob_lambda", "", "Weight of pixels outside the mask", 1e-6, 1e6});
    visit(
        self.ambiguity,
        Field<double>{"cob_ambiguity", "",
                      "Split Gaussians with mean r below this, prune them at the end (0.8: object-centric)", 0.0, 1.0});
  }
};

}  // namespace ngs
