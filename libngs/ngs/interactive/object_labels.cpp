#include "ngs/interactive/object_labels.h"

#include <algorithm>

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/math/mask_variance.h"

namespace ngs::live {

void add_view(const MarkedView& view, WeightSums<>& sums) {
  sums.add(*view.seen);
  for (std::size_t v = 0; v < view.inside.size(); ++v) sums.add_object(view.inside.row[v], 0, view.inside.weight(v));
}

void remove_view(const MarkedView& view, WeightSums<>& sums) {
  sums.remove(*view.seen);
  for (std::size_t v = 0; v < view.inside.size(); ++v) sums.remove_object(view.inside.row[v], 0, view.inside.weight(v));
}

std::vector<std::uint32_t> replace_view(const MarkedView& before, const MarkedView& now, WeightSums<>& sums) {
  NGS_CHECK(before.seen == now.seen, "two masks of one view");
  std::vector<std::uint32_t> changed;
  const ViewSums &old = before.inside, &next = now.inside;
  for (std::size_t a = 0, b = 0; a < old.size() || b < next.size();) {
    const bool has_old = a < old.size() && (b == next.size() || old.row[a] <= next.row[b]);
    const bool has_next = b < next.size() && (a == old.size() || next.row[b] <= old.row[a]);
    const std::uint32_t row = has_old ? old.row[a] : next.row[b];
    if (!(has_old && has_next && old.weight(a) == next.weight(b))) {
      if (has_old) sums.remove_object(row, 0, old.weight(a));
      if (has_next) sums.add_object(row, 0, next.weight(b));
      changed.push_back(row);
    }
    a += has_old, b += has_next;
  }
  return changed;
}

void label_rows(const Exec& exec, const WeightSums<>& sums, const std::vector<std::uint32_t>& rows,
                ObjectLabels& labels) {
  const BoundaryRule rule;
  constexpr std::int64_t kChunk = 1 << 12;
  std::vector<std::int64_t> more(std::size_t((std::int64_t(rows.size()) + kChunk - 1) / kChunk));
  for_each_task(exec, std::ssize(more), [&](std::int64_t chunk) {
    const std::int64_t end = std::min(std::int64_t(rows.size()), (chunk + 1) * kChunk);
    for (std::int64_t r = chunk * kChunk; r < end; ++r) {
      const std::size_t row = rows[std::size_t(r)];
      const double prob = sums.prob(row, 0);
      const bool object = is_object(rule, double(float(prob)));  // compared as in files, whose columns are float
      more[std::size_t(chunk)] += std::int64_t(object) - std::int64_t(labels.label[row] > 0);
      labels.label[row] = float(object), labels.boundary[row] = is_boundary(rule, mask_variance(prob));
    }
  });
  for (const std::int64_t m : more) labels.count += m;
}

}  // namespace ngs::live
