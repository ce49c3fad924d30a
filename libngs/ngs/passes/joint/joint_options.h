#pragma once
// Options of the joint optimisation. Paper's values where it gives any; else our reading (PAPER.md §4).
#include <cmath>
#include <string>
#include <vector>

#include "ngs/ops/field/film_mlp.h"
#include "ngs/ops/field/hash_grid.h"
#include "ngs/ops/losses/loss_mask.h"
#include "ngs/ops/losses/loss_smooth.h"
#include "ngs/options/field.h"
#include "ngs/passes/joint/joint_switches.h"
#include "ngs/stages/boundary/rbf_stage.h"
#include "ngs/stages/boundary/sample_stage.h"

namespace ngs {

/// Adam rates of the Gaussians' parameters; position per world unit of the cameras' extent. The defaults are
/// 3DGS's for a trained model (C20).
struct GaussianRates {
  double position = 1.6e-6, rotation = 1e-3, log_scale = 5e-3, logit_opacity = 2.5e-2, sh_dc = 2.5e-3,
         sh_rest = 1.25e-4;
};

/// The paper's one rate for Gaussians and NeRF (--rate-literal).
inline constexpr double kLiteralRate = 1.6e-4;

/// About an object, where the anchor to the photos is kept to it (--effect region=off).
inline constexpr int kRegionMargin_px = 64;

enum class Quality : std::uint8_t { kDraft, kStandard, kHigh, kReference };
inline constexpr NamedValue<Quality> kQualityNames[] = {{Quality::kDraft, "draft"},
                                                        {Quality::kStandard, "standard"},
                                                        {Quality::kHigh, "high"},
                                                        {Quality::kReference, "reference"}};
inline constexpr NamedValue<MaskLossForm> kMaskLossNames[] = {{MaskLossForm::kBce, "bce"},
                                                              {MaskLossForm::kLinear, "linear"}};
inline constexpr NamedValue<SmoothnessForm> kSmoothnessNames[] = {{SmoothnessForm::kRandom, "random"},
                                                                  {SmoothnessForm::kGradient, "gradient"}};

/// Steps per training view of a quality: every view is visited that often.
inline int epochs_of(Quality quality) {
  switch (quality) {
    case Quality::kDraft: return 1;
    case Quality::kStandard: return 10;
    case Quality::kHigh: return 40;
    case Quality::kReference: return 160;
  }
  return 10;
}

/// Share of the epochs that is taken before contour iterations at half the size, which do the rest of their work.
inline constexpr double kEpochsBeforeContours = 0.3;

inline constexpr int kMaxFeatureValues = 32;

/// The NeRF: its encoding, its network, its rates.
struct FieldOptions {
  double rate_hash = 1e-2, rate_mlp = 1e-3, rate_feature = 2.5e-3;
  int hash_levels = 8, hash_features = 2, hash_log2_table = 15, hash_base = 16, hash_finest = 512;
  int mlp_hidden = 64, mlp_layers = 2, direction_degree = 2;
  int feature_values = 3;
  bool hash_smoothstep = false, concatenate = false, field_positions = false, field_depth = false, field_masks = false;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.rate_hash, Field<double>{"rate_hash", "", "Adam rate of the hash tables", 0, 10});
    visit(self.rate_mlp, Field<double>{"rate_mlp", "", "Adam rate of the network", 0, 10});
    visit(self.rate_feature, Field<double>{"rate_feature", "", "Adam rate of the boundary features f_j", 0, 10});
    visit(self.hash_levels,
          Field<int>{"hash_levels", "", "resolutions L of the hash encoding (Eq. 11)", 1, kMaxHashLevels});
    visit(self.hash_features, Field<int>{"hash_features", "", "features per level: 1, 2, 4 or 8", 1, 8});
    visit(self.hash_log2_table, Field<int>{"hash_log2_table", "", "log2 of the entries of a hashed level", 3, 24});
    visit(self.hash_base, Field<int>{"hash_base", "vertices", "coarsest resolution, along an axis", 2, 4096});
    visit(self.hash_finest,
          Field<int>{"hash_finest", "vertices", "finest resolution, along an axis", 2, kMaxHashResolution});
    visit(self.hash_smoothstep,
          Flag{"hash_smoothstep", "cells blend by 3t^2 - 2t^3: the field's gradient has no jumps at their faces"});
    visit(self.mlp_hidden, Field<int>{"mlp_hidden", "", "width of the network", 16, 128});
    visit(self.mlp_layers, Field<int>{"mlp_layers", "", "hidden layers, each modulated (Eq. 14)", 1, kMaxFilmLayers});
    visit(self.direction_degree,
          Field<int>{"direction_degree", "", "SH bands of the view direction (C14); 0: none", 0, 3});
    visit(self.feature_values,
          Field<int>{"feature_values", "", "values of a boundary feature f_j; the first three start as its colour", 3,
                     kMaxFeatureValues});
    visit(self.concatenate, Flag{"concatenate", "f_inter is an input of the network too, beside f_hash"});
    visit(self.field_positions,
          Flag{"field_positions", "the NeRF's losses move the boundary Gaussians, through Eqs. 8-9 (C25)"});
    visit(self.field_depth,
          Flag{"field_depth", "the NeRF's losses move the rendered depth that its query points follow (C25)"});
    visit(self.field_masks,
          Flag{"field_masks", "the NeRF learns the objects' masks too: a probability at every query point"});
  }
};

/// The steps of Eq. 20. describe() leaves the field to that of FieldOptions.
struct JointOptions : FieldOptions {
  Quality quality = Quality::kStandard;
  std::int64_t steps = 0;
  JointSwitches on;             // as the effects are decided
  bool contours_go_on = false;  // contour iterations at half the size follow and do a part of the work
  double lambda_mask = 0.5, lambda_cont = 0.1, lambda_smooth = 0.05;
  double weight_opacity = 0.5, weight_variance = 0.01;
  bool excess_variance = false;
  MaskLossForm mask_loss = MaskLossForm::kBce;
  double photometric_weight = 1.0;
  int start_steps = 3;
  double rate_label = 0.1, rate_scale = 0.1;
  bool rate_literal = false;
  double rate_decay = 0.1;
  int smooth_points = 2048;
  double smooth_step = 0.01;
  SmoothnessForm smooth_form = SmoothnessForm::kRandom;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.steps,
          Field<std::int64_t>{"steps", "", "optimiser steps, one view each; 0: as --quality says", 0, 100'000'000}.of(
              "joint"));
    visit(self.lambda_mask,
          Field<double>{"lambda_mask", "", "weight of L_mask (Eq. 20)", 0, 1e6}.of("joint|contours,mask"));
    visit(self.lambda_cont, Field<double>{"lambda_cont", "", "weight of L_cont (Eq. 20)", 0, 1e6}.of("cont"));
    visit(self.lambda_smooth, Field<double>{"lambda_smooth", "", "weight of L_smth (Eq. 20)", 0, 1e6}.of("smooth"));
    visit(self.weight_opacity, Field<double>{"weight_opacity", "", "w_alpha of L_align (Eq. 16)", 0, 1e6}.of("align"));
    visit(self.weight_variance,
          Field<double>{"weight_variance", "", "w_v of L_align (Eq. 16, C17)", 0, 1e6}.of("variance"));
    visit(self.excess_variance,
          Flag{"excess_variance", "7x7 term: only variance above the photo's (C17)"}.of("variance"));
    visit(self.mask_loss,
          Choice<MaskLossForm>{"mask_loss", "L_mask: cross-entropy, or COB-GS's linear form (C18)", kMaskLossNames}.of(
              "joint|contours,mask"));
    visit(self.photometric_weight,
          Field<double>{"photometric_weight", "", "weight of 0.8 L1 + 0.2 DSSIM (C16)", 0, 1e6}.of(
              "joint|contours,photometric"));
    visit(self.start_steps,
          Field<int>{"start_steps", "",
                     "labels start this many EM steps from 1/2 (PAPER.md 5.4); 1: at their share of evidence", 1, 100}
              .of("joint"));
    visit(self.rate_label,
          Field<double>{"rate_label", "", "Adam rate of the label logits", 0, 100}.of("joint|contours"));
    visit(self.rate_scale,
          Field<double>{"rate_scale", "", "factor on 3DGS's rates of the Gaussians (C20)", 0, 1e3}.of("joint"));
    visit(self.rate_literal,
          Flag{"rate_literal", "the paper's single rate 1.6e-4 for Gaussians and NeRF (C20)"}.of("joint"));
    visit(self.rate_decay,
          Field<double>{"rate_decay", "", "all rates fall exponentially to this factor", 1e-6, 1}.of("joint|contours"));
    visit(self.smooth_points,
          Field<int>{"smooth_points", "", "query points per step for L_smth", 1, 1 << 24}.of("smooth"));
    visit(
        self.smooth_step,
        Field<double>{"smooth_step", "", "finite-difference step of L_smth, in kernel widths", 1e-6, 10}.of("smooth"));
    visit(self.smooth_form,
          Choice<SmoothnessForm>{"smooth_form", "L_smth: one random difference a point, or its gradient squared (D14)",
                                 kSmoothnessNames}
              .of("smooth"));
  }
};

inline int epochs_of(const JointOptions& options) {
  return int(std::ceil((options.contours_go_on ? kEpochsBeforeContours : 1) * epochs_of(options.quality)));
}

/// Steps of Eq. 20 in all, for `views` training views.
inline std::int64_t steps_of(const JointOptions& options, std::size_t views) {
  return options.steps > 0 ? options.steps : epochs_of(options) * std::int64_t(views);
}

/// The samples of a run: the whole image without its box (Sp), and for a draft half of the nodes and depths along each
/// axis, because one epoch learns little from the field.
inline SampleOptions sample_of(SampleOptions sample, const JointOptions& options) {
  sample.whole_image = !options.on.box;
  if (options.quality != Quality::kDraft) return sample;
  for (int* count : {&sample.rows, &sample.cols, &sample.depth_samples}) *count = (*count + 1) / 2;
  return sample;
}

}  // namespace ngs
