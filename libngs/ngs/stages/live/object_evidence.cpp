#include "ngs/stages/live/object_evidence.h"

#include <algorithm>

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/math/mask_variance.h"
#include "ngs/stages/boundary/variance_stage.h"

namespace ngs::live {

ObjectEvidence::ObjectEvidence(std::int64_t gaussians) {
  weight_.resize(std::size_t(gaussians)), inside_.resize(std::size_t(gaussians));
}

void ObjectEvidence::add(const MarkedView& view) {
  for (std::size_t v = 0; v < view.seen->row.size(); ++v) weight_.add(view.seen->row[v], view.seen->weight[v]);
  for (std::size_t v = 0; v < view.inside.row.size(); ++v) inside_.add(view.inside.row[v], view.inside.weight[v]);
}

void ObjectEvidence::remove(const MarkedView& view) {
  for (std::size_t v = 0; v < view.seen->row.size(); ++v) weight_.subtract(view.seen->row[v], view.seen->weight[v]);
  for (std::size_t v = 0; v < view.inside.row.size(); ++v) inside_.subtract(view.inside.row[v], view.inside.weight[v]);
}

std::vector<std::uint32_t> ObjectEvidence::replace(const MarkedView& before, const MarkedView& now) {
  NGS_CHECK(before.seen == now.seen, "two masks of one view");
  std::vector<std::uint32_t> changed;
  const MaskWeights &old = before.inside, &next = now.inside;
  for (std::size_t a = 0, b = 0; a < old.row.size() || b < next.row.size();) {
    const bool has_old = a < old.row.size() && (b == next.row.size() || old.row[a] <= next.row[b]);
    const bool has_next = b < next.row.size() && (a == old.row.size() || next.row[b] <= old.row[a]);
    const std::uint32_t row = has_old ? old.row[a] : next.row[b];
    if (!(has_old && has_next && old.weight[a] == next.weight[b])) {
      if (has_old) inside_.subtract(row, old.weight[a]);
      if (has_next) inside_.add(row, next.weight[b]);
      changed.push_back(row);
    }
    a += has_old, b += has_next;
  }
  return changed;
}

double ObjectEvidence::share(std::size_t gaussian) const {
  return is_seen(gaussian) ? inside_.value(gaussian) / weight_.value(gaussian) : 0.0;
}

void label_rows(const Exec& exec, const ObjectEvidence& evidence, const std::vector<std::uint32_t>& rows,
                ObjectLabels& labels) {
  const BoundaryRule rule;
  constexpr std::int64_t kChunk = 1 << 12;
  std::vector<std::int64_t> more(std::size_t((std::ssize(rows) + kChunk - 1) / kChunk));
  for_each_task(exec, std::ssize(more), [&](std::int64_t chunk) {
    const std::int64_t end = std::min(std::ssize(rows), (chunk + 1) * kChunk);
    for (std::int64_t r = chunk * kChunk; r < end; ++r) {
      const std::size_t row = rows[std::size_t(r)];
      const double share = evidence.share(row);
      const bool object = double(float(share)) > rule.label_threshold;  // compared as in files, whose columns are float
      more[std::size_t(chunk)] += std::int64_t(object) - std::int64_t(labels.label[row] > 0);
      labels.label[row] = float(object), labels.boundary[row] = mask_variance(share) > rule.tau;
    }
  });
  for (const std::int64_t m : more) labels.count += m;
}

}  // namespace ngs::live
