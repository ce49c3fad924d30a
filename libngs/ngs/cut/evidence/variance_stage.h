#pragma once
// Evidence of all views, closed-form labels and the boundary set.             Eq. (3), Algorithm 1 step 1; C1, C2
#include <functional>
#include <string>
#include <vector>

#include "ngs/core/monitor.h"
#include "ngs/ops/splat/evidence.h"
#include "ngs/options/field.h"
#include "ngs/scene/labels/boundary_rule.h"
#include "ngs/scene/labels/label_column.h"

namespace ngs {

inline constexpr NamedValue<Criterion> kCriterionChoices[] = {{Criterion::kPooled, kCriterionNames[0]},
                                                              {Criterion::kBetweenViews, kCriterionNames[1]},
                                                              {Criterion::kRelativeDiff, kCriterionNames[2]}};

struct VarianceOptions : BoundaryRule {
  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.tau, Field<double>{"tau", "", "Normalised mask variance above which a Gaussian is boundary (Eq. 3, C1)",
                                  0.0, 0.999999});
    visit(self.criterion, Choice<Criterion>{"criterion", "How the mask variance is measured (C2)", kCriterionChoices});
    visit(self.exclusive, Flag{"exclusive", "Assign each Gaussian to at most one object, that of most weight"});
  }
};

using MaskLoader = std::function<ViewMasks(std::size_t index)>;

struct EvidenceInputs {
  const GaussianCloud& cloud;
  const Scene& scene;
  std::vector<std::size_t> views;  // indices of scene.views; must contain no held-out view
  SplatOptions splat;
  MaskLoader load_masks;
};

/// Sums the evidence of the given views. After a stop request to `monitor` the remaining views are skipped.
Evidence accumulate_evidence(const Exec& exec, Monitor& monitor, const EvidenceInputs& in);

/// Throws kUsage unless tau lies in the attainable range [0, 1) of the normalised variance.
void check_tau(const BoundaryRule& rule);

/// Labels, probabilities, variances and boundary membership, one LabelColumns per object. Gaussians without evidence
/// have views = 0, prob = 0, label = 0: undecided, which ngs-extract resolves by its own rule. Calls check_tau.
std::vector<LabelColumns> label_gaussians(const BoundaryRule& rule, const Evidence& evidence);

}  // namespace ngs
