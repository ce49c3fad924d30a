#include "ngs/cut/evidence/method_labels.h"

#include <algorithm>

#include "ngs/core/check.h"
#include "ngs/cut/evidence/leave_one_out.h"
#include "ngs/math/mask_variance.h"
#include "ngs/ops/splat/evidence.h"
#include "ngs/problem/cloud_rows.h"
#include "ngs/problem/region.h"
#include "ngs/problem/view_list.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs {

std::vector<LabelColumns> closed_form_labels(const Exec& exec, Monitor& monitor, const Problem& input) {
  if (!input.labels.empty()) {
    NGS_CHECK(input.labels.size() == input.scene.objects.size(), "one LabelColumns per object");
    return input.labels;
  }
  const auto timed = monitor.scope("evidence");
  return label_gaussians(
      input.rule,
      accumulate_evidence(exec, monitor, {input.cloud, input.scene, input.views, input.splat, input.load_masks}));
}

namespace {

/// Sets the columns of Gaussian i from its weights.
void set_labels(const BoundaryRule& rule, const WeightSums<>& sums, std::size_t i, std::vector<LabelColumns>& labels) {
  const bool one_of_several = rule.exclusive && labels.size() > 1;
  const int owner = one_of_several ? sums.heaviest_object(i) : -1;
  for (std::size_t k = 0; k < labels.size(); ++k) {
    LabelColumns& c = labels[k];
    const double prob = std::min(1.0, sums.prob(i, k));  // the sums started with rounded weights
    c.prob[i] = float(prob);
    c.variance[i] = float(mask_variance(prob));
    c.label[i] = one_of_several ? float(owner == int(k)) : float(is_object(rule, prob));
    c.boundary[i] = float(is_boundary(rule, mask_variance(prob)));
  }
}

}  // namespace

std::vector<LabelColumns> recompute_labels(const Exec& exec, Monitor& monitor, const Problem& input,
                                           const GaussianCloud& cloud) {
  const Problem& uncropped = input.whole();
  const auto masks = [&](std::size_t view) {
    ViewMasks all = uncropped.load_masks(view);
    if (input.uncropped) all.available = all.available && input.load_masks(view).available;
    return all;
  };
  const Evidence evidence =
      accumulate_evidence(exec, monitor, {cloud, uncropped.scene, uncropped.views, input.splat, masks});
  if (monitor.stop_requested()) return input.labels;
  std::vector<LabelColumns> labels = label_gaussians(input.rule, evidence);
  restore_outside_regions(input.labels, labels);
  restore_fixed(input, {}, labels);
  return labels;
}

std::vector<LabelColumns> labels_without_views(const Exec& exec, Monitor& monitor, const Problem& input,
                                               const std::vector<std::size_t>& views) {
  if (!input.uncropped || !input.uncropped->weight || input.rule.criterion != Criterion::kPooled)
    return recompute_labels(exec, monitor, input, input.cloud);
  const auto timed = monitor.scope("evidence");
  const Problem& uncropped = *input.uncropped;
  const RowNumbers with_evidence(rows_with_foreground_evidence(input.labels));
  std::vector<LabelColumns> gathered = gather_labels(exec, input.labels, with_evidence.row);
  std::vector<float> seen_less(gathered[0].prob.size(), 0.f);
  LeaveOneOut rest(exec, with_evidence.size(), int(input.labels.size()), [&](std::size_t v) {
    return packed_sums(exec, uncropped.cloud, {uncropped.scene.views[v].camera, uncropped.load_masks(v)},
                       uncropped.splat, &with_evidence);
  });
  rest.start(gathered, gather_column(exec, *uncropped.weight, 1, with_evidence.row), views);
  const bool every = for_each_view(&monitor, views, [&](std::size_t, std::size_t v) {
    const std::shared_ptr<const PackedSums> own = rest.weights_of(v);
    for (std::size_t part = 0; part < own->parts(); ++part)
      own->for_each(part, [&](std::uint32_t i, const double*) { ++seen_less[i]; });
    rest.remove(v);
  });
  if (!every) return input.labels;
  for (std::size_t i = 0; i < seen_less.size(); ++i) {
    if (seen_less[i] == 0) continue;
    const bool unseen = gathered[0].views[i] <= seen_less[i];  // no weight remains except rounding
    for (LabelColumns& c : gathered) c.views[i] -= std::min(float(c.views[i]), seen_less[i]);
    if (!unseen && rest.sums().weight.value(i) > 0) {
      set_labels(input.rule, rest.sums(), i, gathered);
    } else {
      for (LabelColumns& c : gathered)
        for (const auto column : kLabelColumns) (c.*column)[i] = 0;
    }
  }
  std::vector<LabelColumns> labels = input.labels;
  scatter_labels(exec, gathered, with_evidence.row, labels);
  restore_outside_regions(input.labels, labels);
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
  return double(std::ranges::count_if(labels.label, label_is_foreground));
}

}  // namespace ngs
