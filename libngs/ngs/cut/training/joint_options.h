#pragma once
// Options of the joint optimisation. Defaults are the paper's values, or our reading if it gives none (paper.md §4).
#include <cmath>

#include "ngs/cut/training/joint_switches.h"
#include "ngs/field/rbf_stage.h"
#include "ngs/field/sample_stage.h"
#include "ngs/ops/field/film_mlp.h"
#include "ngs/ops/field/hash_grid.h"
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

/// Share of the epochs that the joint steps get if contour iterations at half the size follow and replace the rest.
inline constexpr double kEpochsBeforeContours = 0.3;

/// Adam rates of the NeRF.
inline constexpr double kHashRate = 1e-2, kMlpRate = 1e-3, kFeatureRate = 2.5e-3;
/// Coarsest resolution and features per level of the NeRF's encoding, and SH degree of the view direction for its
/// colour (C14).
inline constexpr int kHashBase = 16, kHashFeatures = 2, kDirectionDegree = 2;

/// Encoding and network of the NeRF.
struct FieldOptions {
  int hash_levels = 8, hash_log2_table = 15, hash_finest = 512;
  int mlp_hidden = 64, mlp_layers = 2;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.hash_levels,
          Field<int>{"hash_levels", "", "Resolutions L of the hash encoding (Eq. 11)", 1, kMaxHashLevels});
    visit(self.hash_log2_table, Field<int>{"hash_log2_table", "", "log2 of the table size of a hashed level", 3, 24});
    visit(self.hash_finest,
          Field<int>{"hash_finest", "vertices", "Finest resolution along an axis", 2, kMaxHashResolution});
    visit(self.mlp_hidden, Field<int>{"mlp_hidden", "", "Width of the network", 16, 128});
    visit(self.mlp_layers, Field<int>{"mlp_layers", "", "Hidden layers, each modulated (Eq. 14)", 1, kMaxFilmLayers});
  }
};

/// Factor by which all rates decay exponentially over a run.
inline constexpr double kRateDecay = 0.1;

/// Options of the steps of Eq. 20. FieldOptions has its own section in the help, so describe() does not visit its
/// members.
struct JointOptions : FieldOptions {
  Quality quality = Quality::kStandard;
  std::int64_t steps = 0;
  JointSwitches on;                     // set by the decisions on effects
  bool coarse_contours_follow = false;  // contour iterations at half the size follow and replace part of the steps
  double lambda_mask = 0.5, lambda_cont = 0.1, lambda_smooth = 0.05;
  double weight_opacity = 0.5, weight_variance = 0.01;
  double photometric_weight = 1.0;
  int start_steps = 3;      // EM steps from labels of 1/2 to the start labels (paper.md §5.4, decision 011)
  double rate_label = 0.1;  // Adam rate of the label logits
  double rate_scale = 0.1;
  bool at_contours = false;   // steps render the tiles at contours and some others (step_tiles.h); no option
  int smooth_points = 2048;   // query points per step for L_smth
  double smooth_step = 0.01;  // finite-difference step of L_smth, kernel widths (D14)

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.steps,
          Field<std::int64_t>{"steps", "", "Optimiser steps, one view each; 0: set by --quality", 0, 100'000'000}.of(
              "joint"));
    visit(self.lambda_mask,
          Field<double>{"lambda_mask", "", "Weight of L_mask (Eq. 20)", 0, 1e6}.of("joint|contours,mask"));
    visit(self.lambda_cont, Field<double>{"lambda_cont", "", "Weight of L_cont (Eq. 20)", 0, 1e6}.of("cont"));
    visit(self.lambda_smooth, Field<double>{"lambda_smooth", "", "Weight of L_smth (Eq. 20)", 0, 1e6}.of("smooth"));
    visit(self.weight_opacity,
          Field<double>{"weight_opacity", "", "Opacity weight w_alpha of L_align (Eq. 16)", 0, 1e6}.of("align"));
    visit(self.weight_variance,
          Field<double>{"weight_variance", "", "Variance weight w_v of L_align (Eq. 16, C17)", 0, 1e6}.of("variance"));
    visit(self.photometric_weight,
          Field<double>{"photometric_weight", "", "Weight of 0.8 L1 + 0.2 DSSIM (C16)", 0, 1e6}.of(
              "joint|contours,photometric"));
    visit(self.rate_scale,
          Field<double>{"rate_scale", "", "Factor on the learning rates of 3DGS (C20)", 0, 1e3}.of("joint"));
  }
};

inline int epochs_of(const JointOptions& options) {
  return int(
      std::ceil((options.coarse_contours_follow ? kEpochsBeforeContours : 1) * preset_of(options.quality).epochs));
}

/// Total number of steps for `views` training views.
inline std::int64_t steps_of(const JointOptions& options, std::size_t views) {
  return options.steps > 0 ? options.steps : epochs_of(options) * std::int64_t(views);
}

/// The sampling options of a run: the whole image if the effect `box` is off, and half of the nodes and depths along
/// each axis if the preset halves the samples.
inline SampleOptions sample_of(SampleOptions sample, const JointOptions& options, double world_unit) {
  sample.whole_image = !options.on.box, sample.world_unit = world_unit;
  if (!preset_of(options.quality).half_samples) return sample;
  for (int* count : {&sample.rows, &sample.cols, &sample.depth_samples}) *count = (*count + 1) / 2;
  return sample;
}

}  // namespace ngs
