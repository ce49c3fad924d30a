#pragma once
// Checks whether masks fit their views and each other. Closed-form labels of some views are rendered back into these
// views and compared with the masks at a reduced size: the smaller of the IoU of object and background. Wrong masks
// contradict each other, so their labels match them badly. Masks with a usual mistake undone are compared in the same
// way to find the cause. Masks with the same error in every view, such as inverted ones, agree with each other:
// scene_check.h finds these.
#include <cstdint>
#include <utility>
#include <vector>

#include "ngs/capture/mask_repair.h"
#include "ngs/core/monitor.h"
#include "ngs/cut/evidence/variance_stage.h"
#include "ngs/options/field.h"
#include "ngs/scene/scene.h"

namespace ngs {

struct MaskAgreementOptions {
  double min_mask_agreement = 0.4;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.min_mask_agreement,
          Field<double>{"min_mask_agreement", "IoU",
                        "Fail if labels made from the masks match these masks less, or with a usual mistake of masks "
                        "undone match better; negative: no check",
                        -1, 1});
  }
};

struct RepairedAgreement {
  MaskRepair repair;
  std::size_t views = 0;         // with a mask before and after the repair; fewer than two: not measured
  double before = 1, after = 1;  // mean IoU over these views
  double gain() const { return after - before; }
};

enum class MaskVerdict : std::uint8_t { kFit, kRepairable, kIdsContradict, kContradict };

struct MaskAgreement {
  std::size_t views = 0;                    // compared; 0: nothing to compare, nothing is measured
  double given = 1, least = 1;              // mean and least IoU of the masks as given, all objects as one
  std::vector<RepairedAgreement> repaired;  // the measured ones
  RepairedAgreement inverted;               // inverted masks agree with each other: no gain does not mean right ones
  std::vector<double> objects;              // [K] mean IoU of each; -1: in no compared view. Empty: one object
  std::vector<std::size_t> low;             // objects that match badly alone; empty unless there are two or more
  double alone = 1, together = 1;           // mean IoU of these objects, and of all of them as one

  /// Repairs of single masks of one object, at most half of them unless all are inverted, after which all fit with a
  /// mean IoU of `single_after`.
  std::vector<std::pair<std::size_t, MaskRepair>> single;  // with the index of the view
  double single_after = 1;

  /// The repair of `repaired` that gains most, in half of the views or more; null: none.
  const RepairedAgreement* best() const;
  /// The repair that makes the masks fit; null: none.
  const RepairedAgreement* repair_that_fits() const;
  MaskVerdict verdict(const MaskAgreementOptions& options) const;
};

/// Nothing to compare: fewer than two masks, all empty or all full, or no usable Gaussian.
/// `in.views`: the training views. Views without a mask are skipped; masks of other views are never loaded.
MaskAgreement measure_mask_agreement(const Exec& exec, Monitor& monitor, const EvidenceInputs& in);

}  // namespace ngs
