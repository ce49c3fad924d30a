#pragma once
// What happens before any method sees model and masks: differences of exposure are taken from the photos
// (--effect exposure), masks that the others contradict are left out
// (--effect mask-outliers), floaters before the object are taken out (--effect floaters), and what masks claim apart from the
// object is taken for unseen (--effect components).
#include <string>
#include <vector>

#include "ngs/passes/exposure/exposure.h"
#include "ngs/passes/floaters/floaters.h"
#include "ngs/passes/mask_outliers/mask_outliers.h"
#include "optimise.h"

namespace ngs::joint {

/// What replaces the model that was read; empty where nothing was removed.
struct FloaterOutcome {
  GaussianCloud cloud;
  std::vector<LabelColumns> labels;
  std::vector<float> floater;  // [N] 1: removed
  FloaterPlan plan;
  bool removed() const { return !floater.empty(); }
};

/// Whether a mask or a Gaussian is wrong shows at half the size, where that still is a picture.
int decision_shrink(const Scene& scene);

/// Warns where the model explains the photos no better than import asks for: then it is another scene's. Three views are asked.
void compare_with_photos(cli::Run& run, const Problem& input);

/// Gains of all photos, at the size of decisions; the report has them.
std::vector<ViewExposure> handle_exposure(cli::Run& run, const Problem& input);

/// `input` with the photos as one exposure would show them; `exposures` must outlive it.
Problem with_levelled_photos(const Problem& input, const std::vector<ViewExposure>& exposures);

/// Judges the masks at the size of decisions, warns, and notes the figures in the report.
MaskOutliers handle_mask_outliers(cli::Run& run, const Problem& input);

/// `input` with only the masks that `trust`, which must outlive it, leaves, and labels that follow from them.
Problem with_consistent_masks(cli::Run& run, const Problem& input, const MaskOutliers& trust);

/// Searches, removes, warns, and notes the figures in the report. A draft searches at half the size of
/// decisions, and refits there, briefly; so does a budget that has no room for more. `kept`: as the run did that is resumed.
FloaterOutcome handle_floaters(cli::Run& run, const Problem& input, Quality quality, Budget& budget,
                               const std::optional<FloaterPlan>& kept);

/// `input` with the model and labels of the outcome, which must outlive it, where something was removed.
Problem without_floaters(const Problem& input, const FloaterOutcome& outcome);

/// Labels without components, which are held as they are; the report says how many. True where there were any: they leave the
/// boundary set, so that a field made for it no longer fits.
bool release_disconnected(cli::Run& run, Problem& input);

}  // namespace ngs::joint
