#pragma once
// Labels shared by the methods of ngs-joint: closed form, recomputation, and labels fixed by hand.
#include "ngs/problem/problem.h"
#include "ngs/stages/boundary/variance_stage.h"

namespace ngs {

/// One LabelColumns per object: those of the input, or the closed form over its views if the input has none.
std::vector<LabelColumns> closed_form_labels(const Exec& exec, Monitor& monitor, const Problem& input);

/// Recomputes labels from new evidence with the boundary rule of the input's labels: the criterion whose variances are
/// nearest to theirs, and as tau the largest variance that is not boundary there. Hand-fixed labels stay. For stages
/// that change the model or the masks. Returns the input's labels after a stop request to `monitor`.
std::vector<LabelColumns> labels_anew(const Exec& exec, Monitor& monitor, const Problem& input,
                                      const GaussianCloud& cloud);

/// Labels of a windowed problem without the evidence of `views`, which is subtracted from the evidence of all full
/// views. The latter is read from the labels and their weight, so results differ from a recomputation by their rounding
/// (2^-24). Without a known weight, or with another criterion than pooled, all evidence is recomputed.
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
