#pragma once
// What the methods of ngs-joint share: where evidence comes from, and whose label no method may change.
#include "ngs/problem/problem.h"
#include "ngs/stages/boundary/variance_stage.h"

namespace ngs {

/// One LabelColumns per object: the input's, or those of the closed form over its views where it brings none.
std::vector<LabelColumns> closed_form_labels(const Exec& exec, Monitor& monitor, const Problem& input);

/// Labels from evidence gathered anew, with the boundary rule that the input's own labels follow: the criterion is the
/// one that gives variances like theirs, tau the largest variance that is not boundary there. Hand-fixed labels stay.
/// For stages that change the model or the masks. The input's own where `monitor` was asked to stop.
std::vector<LabelColumns> labels_anew(const Exec& exec, Monitor& monitor, const Problem& input,
                                      const GaussianCloud& cloud);

/// The labels of a problem in windows without what some of its views say, of whole views: the evidence of the others is
/// that of all less theirs, and the labels and their weight have that of all. As labels_anew() but for the rounding of
/// these columns (2^-24); that is what is called where the weight is not known, or the labels' variances are not those
/// of the pooled criterion.
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
