#pragma once
// Options of the method cob (methods/method_cob.h), which released takes as well.
#include "ngs/options/field.h"

namespace ngs {

enum class CobDivisor : std::uint8_t { kVisible, kLiteral };
inline constexpr NamedValue<CobDivisor> kCobDivisorNames[] = {{CobDivisor::kVisible, "visible"},
                                                              {CobDivisor::kLiteral, "literal"}};

struct CobOptions {
  int rounds = 2;
  double lambda = 1, label_lr = 0.1, extract = 0.9;
  double ambiguity = 0.5, split_scale = 0.01;
  CobDivisor divisor = CobDivisor::kVisible;
  bool prune = true;
  double position_lr = 1.6e-6, dc_lr = 0.0025, rest_lr = 0.000125, opacity_lr = 0.025, scale_lr = 0.005,
         rotation_lr = 0.001;
  double dssim_weight = 0.2;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.rounds, Field<int>{"cob_rounds", "",
                                  "mask and texture phase pairs before the last mask phase; 0: labels only", 0, 1000});
    visit(self.lambda, Field<double>{"cob_lambda", "", "weight of pixels outside the mask", 1e-6, 1e6});
    visit(self.label_lr, Field<double>{"cob_label_lr", "", "Adam rate of the label logits", 1e-6, 100.0});
    visit(self.extract, Field<double>{"cob_extract", "", "label 1 where the sigmoid exceeds this", 0.0, 1.0});
    visit(self.ambiguity,
          Field<double>{"cob_ambiguity", "",
                        "mean r below which a Gaussian is split, at last pruned (0.8 for object-centric scenes)", 0.0,
                        1.0});
    visit(self.split_scale,
          Field<double>{"cob_split_scale", "of the extent", "only larger Gaussians are split", 0.0, 10.0});
    visit(self.divisor, Choice<CobDivisor>{"cob_divisor", "views that the mean of r is taken over", kCobDivisorNames});
    visit(self.prune, Flag{"cob_prune", "delete what is still ambiguous at the end"});
    visit(self.position_lr, Field<double>{"cob_position_lr", "of the extent", "texture phases", 0.0, 1.0});
    visit(self.dc_lr, Field<double>{"cob_dc_lr", "", "constant colour", 0.0, 1.0});
    visit(self.rest_lr, Field<double>{"cob_rest_lr", "", "other SH coefficients", 0.0, 1.0});
    visit(self.opacity_lr, Field<double>{"cob_opacity_lr", "", "logit of the opacity", 0.0, 1.0});
    visit(self.scale_lr, Field<double>{"cob_scale_lr", "", "logarithm of the scale", 0.0, 1.0});
    visit(self.rotation_lr, Field<double>{"cob_rotation_lr", "", "quaternion", 0.0, 1.0});
    visit(self.dssim_weight, Field<double>{"cob_dssim_weight", "", "weight of 1 - SSIM; L1 has the rest", 0.0, 1.0});
  }
};

}  // namespace ngs
