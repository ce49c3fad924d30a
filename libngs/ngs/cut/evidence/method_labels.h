#pragma once
// Labels shared by the methods of ngs-joint: closed form, recomputation, and labels fixed by hand.
#include "ngs/cut/evidence/variance_stage.h"
#include "ngs/problem/problem.h"

namespace ngs {

/// One LabelColumns per object: those of the input, or the closed form over its views if the input has none.
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

/// Restores label and prob of hand-fixed Gaussians from the input. Row r of `labels` descends from input row
/// source_row[r]; an empty `source_row` is the identity.
void restore_fixed(const Problem& input, const std::vector<std::int64_t>& source_row,
                   std::vector<LabelColumns>& labels);

inline bool is_fixed(const Problem& input, std::size_t row) { return !input.fixed.empty() && input.fixed[row] == 1.f; }

/// Number of Gaussians labelled as the object, for Solution::figures.
double labelled_count(const LabelColumns& labels);

}  // namespace ngs
