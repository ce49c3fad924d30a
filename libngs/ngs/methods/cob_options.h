#pragma once
// Options of the method cob (methods/method_cob.h), which released takes as well.
#include "ngs/options/field.h"

namespace ngs {

/// Views that the mean of r is taken over: those that see the Gaussian, or all, as the published code does.
enum class CobDivisor : std::uint8_t { kVisible, kAll };

struct CobOptions {
  int rounds = 2;
  double lambda = 1, ambiguity = 0.5;
  // As published; no flag sets them.
  CobDivisor divisor = CobDivisor::kVisible;
  double split_scale = 0.01;  // of the extent: only larger Gaussians are split
  double position_lr = 1.6e-6, dc_lr = 0.0025, rest_lr = 0.000125, opacity_lr = 0.025, scale_lr = 0.005,
         rotation_lr = 0.001;  // Adam rates of the texture phases; position of the extent

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.rounds, Field<int>{"cob_rounds", "",
                                  "mask and texture phase pairs before the last mask phase; 0: labels only", 0, 1000});
    visit(self.lambda, Field<double>{"cob_lambda", "", "weight of pixels outside the mask", 1e-6, 1e6});
    visit(self.ambiguity,
          Field<double>{"cob_ambiguity", "",
                        "mean r below which a Gaussian is split, at last pruned (0.8 for object-centric scenes)", 0.0,
                        1.0});
  }
};

}  // namespace ngs
