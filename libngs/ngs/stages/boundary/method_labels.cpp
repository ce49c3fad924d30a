#include "ngs/stages/boundary/method_labels.h"

#include <algorithm>
#include <cmath>

#include "ngs/core/check.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs {

std::vector<LabelColumns> closed_form_labels(const Exec& exec, Monitor& monitor, const Problem& input) {
  if (!input.labels.empty()) {
    NGS_CHECK(input.labels.size() == input.scene.objects.size(), "one LabelColumns per object");
    return input.labels;
  }
  const auto timed = monitor.scope("evidence");
  return label_gaussians(
      {}, accumulate_evidence(exec, monitor, {input.cloud, input.scene, input.views, input.splat, input.load_masks}));
}

namespace {

/// How far the variances of the Gaussians that both have seen lie apart, summed up.
double variance_distance(const std::vector<LabelColumns>& a, const std::vector<LabelColumns>& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    for (std::size_t i = 0; i < a[k].views.size(); ++i)
      if (a[k].views[i] > 0 && b[k].views[i] > 0) sum += std::abs(double(a[k].variance[i]) - double(b[k].variance[i]));
  return sum;
}

/// Labels by the criterion that gives the variances which are nearest to the given ones: what changed in masks and
/// model since concerns few Gaussians, another criterion nearly all.
std::vector<LabelColumns> labels_like(const std::vector<LabelColumns>& given, VarianceOptions rule,
                                      const Evidence& evidence) {
  std::vector<LabelColumns> best;
  double least = INFINITY;
  for (const NamedValue<Criterion>& named : kCriterionNames) {
    rule.criterion = named.value;
    std::vector<LabelColumns> labels = label_gaussians(rule, evidence);
    const double apart = variance_distance(given, labels);
    if (apart < least) least = apart, best = std::move(labels);
  }
  return best;
}

}  // namespace

std::vector<LabelColumns> labels_anew(const Exec& exec, Monitor& monitor, const Problem& input,
                                      const GaussianCloud& cloud) {
  VarianceOptions rule;
  float largest = -1;
  for (const LabelColumns& c : input.labels)
    for (std::size_t i = 0; i < c.views.size(); ++i)
      if (c.views[i] > 0 && !is_set(c.boundary[i])) largest = std::max(largest, c.variance[i]);
  // Just above it: the column is rounded, and what it was rounded from must not be boundary either.
  if (largest >= 0) rule.tau = std::min(double(std::nextafter(largest, 2.f)), std::nextafter(1.0, 0.0));
  const Evidence evidence =
      accumulate_evidence(exec, monitor, {cloud, input.scene, input.views, input.splat, input.load_masks});
  if (monitor.stop_requested()) return input.labels;
  std::vector<LabelColumns> labels = labels_like(input.labels, rule, evidence);
  restore_fixed(input, {}, labels);
  return labels;
}

void restore_fixed(const Problem& input, const std::vector<std::int64_t>& source_row,
                   std::vector<LabelColumns>& labels) {
  if (input.fixed.empty() || input.labels.empty()) return;
  for (std::size_t k = 0; k < labels.size(); ++k)
    for (std::size_t row = 0; row < labels[k].label.size(); ++row) {
      const std::size_t source = source_row.empty() ? row : std::size_t(source_row[row]);
      if (!is_fixed(input, source)) continue;
      labels[k].label[row] = input.labels[k].label[source];
      labels[k].prob[row] = input.labels[k].prob[source];
    }
}

double labelled_count(const LabelColumns& labels) {
  return double(std::ranges::count_if(labels.label, label_says_object));
}

}  // namespace ngs
