#pragma once
// Options of the joint optimisation. Defaults are the paper's values, or our reading if it gives none (paper.md §4).
#include "ngs/field/field_options.h"
#include "ngs/field/sample_stage.h"
#include "ngs/options/field.h"
#include "ngs/problem/preset.h"

namespace ngs {

/// Adam rates of the Gaussians' parameters; position per world unit of the cameras' extent. The defaults are
/// 3DGS's for a trained model (C20).
struct GaussianRates {
  double position = 1.6e-6, rotation = 1e-3, log_scale = 5e-3, logit_opacity = 2.5e-2, sh_dc = 2.5e-3,
         sh_rest = 1.25e-4;
};

/// Margin of the photometric anchor about the object with --effect whole-photo=off.
inline constexpr int kAnchorMargin_px = 64;

/// Factor by which all rates decay exponentially over a run.
inline constexpr double kRateDecay = 0.1;

/// Options of the steps of Eq. 20. FieldOptions has its own section in the help: describe() does not visit it.
struct JointOptions : FieldOptions, PartSwitches {
  Quality quality = Quality::kStandard;
  std::int64_t steps = 0;
  bool coarse_contours_follow = false;  // contour iterations at half the size follow and replace the steps
  int start_steps = 3;      // EM steps from labels of 1/2 to the start labels (paper.md §5.4, decision 011)
  double rate_label = 0.1;  // Adam rate of the label logits
  double rate_scale = 0.1;
  int averaged_epochs = 0;   // the result is the mean of the parameters at the ends of the last epochs; no option
  bool at_contours = false;  // steps render the tiles at contours and some others (step_tiles.h); no option

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.steps,
          Field<std::int64_t>{"steps", "", "Optimiser steps, one view each; 0: set by --quality", 0, 100'000'000}.of(
              "joint"));
    visit(self.rate_scale,
          Field<double>{"rate_scale", "", "Factor on the learning rates of 3DGS (C20)", 0, 1e3}.of("joint"));
  }
};

inline int epochs_of(const JointOptions& options) {
  return options.coarse_contours_follow ? 0 : preset_of(options.quality).epochs;
}

inline std::int64_t steps_of(const JointOptions& options, std::size_t views) {
  return options.steps > 0 ? options.steps : epochs_of(options) * std::int64_t(views);
}

}  // namespace ngs
