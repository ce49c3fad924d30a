#include "ngs/edit/finish/alone.h"

#include <algorithm>

#include "ngs/math/row_numbers.h"
#include "ngs/ops/splat/evidence.h"
#include "ngs/problem/cloud_rows.h"

namespace ngs::finish {
namespace {

constexpr int kRounds = 2;  // removed Gaussians uncover others behind them
// Bounds on a Gaussian's weight outside the masks, relative to its weight inside. The second, for Gaussians that no
// view sees, is higher: occluded weight may be an unseen side of the object.
constexpr double kOutsideTimes = 1, kHiddenTimes = 10;

}  // namespace

Alone rendered_alone(const Exec& exec, const AloneViews& in, const GaussianCloud& object,
                     std::vector<std::uint8_t> keep) {
  Alone out{std::move(keep)};
  const GaussianCloud part = gather_rows(exec, object, RowNumbers(out.keep).row);
  const SplatOptions splat = prepared_for(exec, in.splat, part);
  RenderRequest request;
  request.colour = false;
  request.depth = true;
  for (const SupportView& view : in.views) {
    out.seen.emplace_back();
    const Camera window = view.window();
    if (window.width_px == 0) continue;
    out.seen.back() = view.seen_alone(render(exec, part, window, splat, request), in.behind);
    const WrongPixels wrong = view.wrong_pixels(out.seen.back());
    out.wrong.beyond += wrong.beyond;
    out.wrong.missing += wrong.missing;
  }
  return out;
}

bool plane_cuts_off(const WrongPixels& with, const WrongPixels& without) { return without.cost() < with.cost(); }

std::vector<std::uint8_t> contradicted(const Exec& exec, const AloneViews& in, const AloneObject& object,
                                       const Alone& alone) {
  const std::vector<std::int64_t> rows = RowNumbers(alone.keep).row;
  const GaussianCloud part = gather_rows(exec, object.cloud, rows);
  EvidenceSum sum(exec, part, 2, prepared_for(exec, in.splat, part));
  for (std::size_t v = 0; v < in.views.size(); ++v) {
    const Camera window = in.views[v].window();
    if (window.width_px > 0) sum.add({window, in.views[v].masks_alone(alone.seen[v])});
  }
  const Evidence found = sum.result();
  std::vector<std::uint8_t> out(alone.keep.size());
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const auto i = std::size_t(rows[r]);
    const double within = found.object_weight(r, 0);
    const double hidden = found.object_weight(r, 1);
    const double outside = found.weight.value(r) - within - hidden;
    out[i] = outside > kOutsideTimes * within || (!object.seen[i] && outside + hidden > kHiddenTimes * within);
  }
  return out;
}

void drop_contradicted(const Exec& exec, const AloneViews& in, const AloneObject& object, Alone& alone) {
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<std::uint8_t> found = contradicted(exec, in, object, alone);
    if (std::ranges::count(found, std::uint8_t(1)) == 0) return;
    std::vector<std::uint8_t> fewer = alone.keep;
    for (std::size_t i = 0; i < fewer.size(); ++i)
      if (found[i]) fewer[i] = 0;
    Alone now = rendered_alone(exec, in, object.cloud, std::move(fewer));
    if (now.wrong.count() > alone.wrong.count()) return;
    alone = std::move(now);
  }
}

}  // namespace ngs::finish
