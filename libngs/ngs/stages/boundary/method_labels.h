#pragma once
// What the methods of ngs-joint share: where evidence comes from, and whose label no method may change.
#include "ngs/problem/problem.h"
#include "ngs/stages/boundary/variance_stage.h"

namespace ngs {

/// One LabelColumns per object: the input's, or those of the closed form over its views where it brings none.
std::vector<LabelColumns> closed_form_labels(const Exec& exec, Monitor& monitor, const Problem& input);

/// Labels from the evidence of `cloud` and the current masks, by input.rule. Hand-fixed labels stay. For passes that
/// change the model or the masks. Returns the input's labels if `monitor` requests a stop.
std::vector<LabelColumns> recompute_labels(const Exec& exec, Monitor& monitor, const Problem& input,
                                           const GaussianCloud& cloud);

/// The labels without the evidence of `views`, taken from whole views if the problem is cropped: the evidence of all
/// views (input.labels and their weight) minus that of these. Equals recompute_labels() up to the rounding of those
/// columns (2^-24); falls back to it if the weight is not known or the criterion is not pooled.
std::vector<LabelColumns> labels_without_views(const Exec& exec, Monitor& monitor, const Problem& input,
                                               const std::vector<std::size_t>& views);

/// Hand-fixed Gaussians get their input label (and prob) back. Rows of `labels` are the input's unless
/// `source_row` says from which input row each descends.
void restore_fixed(const Problem& input, const std::vector<std::int64_t>& source_row,
                   std::vector<LabelColumns>& labels);

inline bool is_fixed(const Problem& input, std::size_t row) { return !input.fixed.empty() && input.fixed[row] == 1.f; }

/// Number of Gaussians labelled as the object, for Solution::figures.
double labelled_count(const LabelColumns& labels);

}  // namespace ngs
