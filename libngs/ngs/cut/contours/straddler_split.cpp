#include "ngs/cut/contours/straddler_split.h"

#include <algorithm>

#include "ngs/ops/splat/evidence.h"
#include "ngs/problem/view_list.h"

namespace ngs {

Straddling straddling(const Exec& exec, const Problem& input, const GaussianCloud& cloud, const RowNumbers* of) {
  const std::size_t objects = input.scene.objects.size(), rows = std::size_t(of ? of->size() : cloud.size());
  Straddling all{std::vector<double>(rows), {}, Evidence(of ? of->size() : 0, int(objects))};
  all.weight.resize(rows);
  const SplatOptions splat = prepared_for(exec, input.splat, cloud);
  for_each_view(input.monitor, input.views, [&](std::size_t, std::size_t view) {
    const ViewMasks masks = input.load_masks(view);
    if (!masks.available) return;
    const ViewSums seen = view_sums(exec, cloud, {input.scene.views[view].camera, masks}, splat, of);
    for (std::size_t v = 0; v < seen.size(); ++v) {
      double most = 0;
      for (std::size_t k = 0; k < objects; ++k) {
        const double inside = seen.object_weight(v, k);
        most = std::max(most, std::min(inside, seen.weight(v) - inside));
      }
      const std::size_t row = seen.row[v];
      all.px[row] += most;
      all.weight.add(row, seen.weight(v));
      if (of) all.evidence.add(row, seen.at(v));
    }
  });
  return all;
}

std::vector<CloudRow> split_straddlers(const std::vector<double>& straddling_px, double least_px) {
  std::vector<CloudRow> rows, halves;
  for (std::size_t i = 0; i < straddling_px.size(); ++i) {
    const auto row = std::int64_t(i);
    if (straddling_px[i] > least_px)
      halves.insert(halves.end(), {{row, RowOrigin::kHalf0}, {row, RowOrigin::kHalf1}});
    else
      rows.push_back({row, RowOrigin::kKept});
  }
  rows.insert(rows.end(), halves.begin(), halves.end());
  return rows;
}

}  // namespace ngs
