#include "ngs/edit/finish/alone.h"

#include <algorithm>

#include "ngs/math/row_numbers.h"
#include "ngs/ops/splat/evidence.h"
#include "ngs/problem/cloud_rows.h"

namespace ngs::finish {
namespace {

constexpr int kRounds = 2;  // what is left out uncovers Gaussians behind it
// Of a Gaussian's weight within the mask: with more outside it is contradicted. The second is for weight that other
// things hide in the scene: an unseen side may be there as well as haze.
constexpr double kOutsideShare = 1, kHiddenShare = 10;

/// [object] as Alone::contradicted; `rows`: of the sums.
std::vector<std::uint8_t> contradicted(const Evidence& found, const std::vector<std::int64_t>& rows,
                                       const std::vector<std::uint8_t>& seen) {
  std::vector<std::uint8_t> out(seen.size());
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const auto i = std::size_t(rows[r]);
    const double within = found.object_weight(r, 0);
    const double hidden = found.object_weight(r, 1);
    const double outside = found.weight.value(r) - within - hidden;
    out[i] = outside > kOutsideShare * within || (!seen[i] && outside + hidden > kHiddenShare * within);
  }
  return out;
}

}  // namespace

Alone rendered_alone(const Exec& exec, const AloneViews& in, const AloneObject& object, std::vector<std::uint8_t> keep,
                     bool finds_contradicted) {
  Alone out{std::move(keep)};
  const std::vector<std::int64_t> rows = RowNumbers(out.keep).row;
  const GaussianCloud part = gather_rows(exec, object.cloud, rows);
  const SplatOptions splat = prepared_for(exec, in.splat, part);
  RenderRequest request;
  request.colour = false;
  request.depth = true;
  EvidenceSum sum(exec, part, 2, splat);
  for (const SupportView& view : in.views) {
    const Camera window = view.window();
    if (window.width_px == 0) continue;
    const RenderedView rendered = render(exec, part, window, splat, request);
    out.wrong += view.wrong_pixels(rendered);
    if (!finds_contradicted) continue;
    const ViewMasks masks = view.masks_alone(rendered, in.behind);
    sum.add({window, masks});
  }
  if (finds_contradicted) out.contradicted = contradicted(sum.result(), rows, object.seen);
  return out;
}

void drop_contradicted(const Exec& exec, const AloneViews& in, const AloneObject& object, Alone& alone) {
  for (int round = 0; round < kRounds; ++round) {
    if (std::ranges::count(alone.contradicted, std::uint8_t(1)) == 0) return;
    std::vector<std::uint8_t> fewer = alone.keep;
    for (std::size_t i = 0; i < fewer.size(); ++i)
      if (alone.contradicted[i]) fewer[i] = 0;
    Alone now = rendered_alone(exec, in, object, std::move(fewer), round + 1 < kRounds);
    if (now.wrong > alone.wrong) return;
    alone = std::move(now);
  }
}

}  // namespace ngs::finish
