#pragma once
// ngs-joint --method cob: COB-GS with given masks.                                          paper.md §6.3
//
// Two kinds of phases alternate, each of 2V iterations for V training views. A mask phase trains one label logit per
// Gaussian against the linear loss, then splits the large Gaussians that touch pixels inside and outside the mask.
// A texture phase trains all other parameters against the photos. The last phase is a mask phase that ends with
// pruning instead of splitting. Labels: sigmoid > 0.9.
//
// The statistic is r = |n+ - n-| / (n+ + n-) per view, where a Gaussian touches n+ pixels inside and n- outside the
// mask, averaged over the views of the phase. The published code divides by all views and counts r = 1 for a view
// in which the Gaussian is not visible, so its threshold depends on visibility (CobDivisor::kAll). The default
// divides by the number of views in which the Gaussian is visible.
#include "ngs/core/monitor.h"
#include "ngs/cut/evidence/method_labels.h"
#include "ngs/make/fit/fit_stage.h"
#include "ngs/ops/losses/photometric.h"
#include "ngs/options/field.h"
#include "ngs/problem/cloud_rows.h"
#include "ngs/problem/problem.h"

namespace ngs {

// The state of a COB-GS run and its phases. Internal to the methods cob and released.      paper.md §6.3

/// Divisor of the sum of r: the views in which the Gaussian is visible, or all views as in the published code.
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

/// Adds a term to the gradient of the colours in a texture step. `logit` [N, K]: label logits.
using ColourTerm = std::function<void(const Exec& exec, const GaussianCloud& cloud, const std::vector<float>& logit,
                                      std::vector<float>& grad_sh_dc)>;

class CobTrainer {
 public:
  CobTrainer(const CobOptions& options, const Problem& input);

  /// Two passes over the views. Afterwards evidence() is that of this phase; split() and prune() invalidate it.
  void mask_phase(const Exec& exec, Monitor& monitor);
  void texture_phase(const Exec& exec, Monitor& monitor, const ColourTerm& colour_term);
  void split(const Exec& exec);
  void prune(const Exec& exec);
  Solution result(Monitor& monitor);

  /// Mean r of the last mask phase, the smallest over the objects; 1 for Gaussians that were never visible.
  std::vector<double> certainty() const;
  const GaussianCloud& cloud() const { return cloud_; }
  const std::vector<float>& logit() const { return logit_; }
  const std::vector<std::int64_t>& source_row() const { return source_row_; }
  const Evidence& evidence() const { return evidence_; }

 private:
  void apply(const Exec& exec, const std::vector<CloudRow>& rows);
  void label_step(const Exec& exec, const ViewSums& view);
  void texture_step(const Exec& exec, std::size_t view, const ImageF& photo, const ColourTerm& colour_term);
  bool keeps_label(std::size_t row) const { return is_fixed(input_, std::size_t(source_row_[row])); }

  const CobOptions& options_;
  const Problem& input_;
  double extent_;
  int objects_;
  GaussianCloud cloud_;
  std::vector<std::int64_t> source_row_;
  std::vector<float> logit_;  // [N, K]
  AdamMoments label_moments_;
  GaussianMoments moments_;
  Evidence evidence_;                  // of the last mask phase
  std::vector<LabelColumns> columns_;  // closed-form labels of evidence_, edited together with the rows
  std::int64_t label_steps_ = 0, texture_steps_ = 0, epochs_ = 0, edits_ = 0;
  std::int64_t split_ = 0, pruned_ = 0, mask_views_ = 0;
  double first_photometric_ = 0, last_photometric_ = 0;
  SplatPass pass_;
  PhotometricPass<float> photometric_;
  CloudGradients gradients_;
  ViewGradients image_gradient_;
};

/// All phases of a run. `colour_term` may be empty.
Solution run_cob_schedule(const Exec& exec, Monitor& monitor, const CobOptions& options, const Problem& input,
                          const ColourTerm& colour_term);

Solution run_cob(const Exec& exec, Monitor& monitor, const CobOptions& options, const Problem& input);

}  // namespace ngs
