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

/// Alpha and depth of the object alone.
RenderedView render_alone(const Exec& exec, const AloneViews& in, const GaussianCloud& object, const Camera& camera) {
  RenderRequest request;
  request.colour = false;
  request.depth = true;
  return render(exec, object, camera, in.splat, request);
}

/// 1: the Gaussian is contradicted.
std::vector<std::uint8_t> contradicted(const Exec& exec, const AloneViews& in, const GaussianCloud& object,
                                       const std::vector<std::uint8_t>& seen) {
  EvidenceSum sum(exec, object, 2, in.splat);
  for (const SupportView& view : in.views) {
    const ViewMasks masks = view.masks_alone(render_alone(exec, in, object, view.camera()), in.behind);
    if (masks.available) sum.add({view.camera(), masks});
  }
  const Evidence found = sum.result();
  std::vector<std::uint8_t> out(seen.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double all = found.weight.value(i), within = found.object_weight(i, 0), hidden = found.object_weight(i, 1);
    const double outside = all - within - hidden;
    out[i] = outside > kOutsideShare * within || (!seen[i] && outside + hidden > kHiddenShare * within);
  }
  return out;
}

}  // namespace

std::int64_t wrong_pixels(const Exec& exec, const AloneViews& in, const GaussianCloud& object,
                          const std::vector<std::uint8_t>& keep) {
  const GaussianCloud kept = gather_rows(exec, object, RowNumbers(keep).row);
  std::int64_t wrong = 0;
  for (const SupportView& view : in.views) wrong += view.wrong_pixels(render_alone(exec, in, kept, view.camera()));
  return wrong;
}

std::int64_t drop_contradicted(const Exec& exec, const AloneViews& in, const GaussianCloud& object,
                               const std::vector<std::uint8_t>& seen, std::vector<std::uint8_t>& keep) {
  std::int64_t dropped = 0, wrong = wrong_pixels(exec, in, object, keep);
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<std::int64_t> rows = RowNumbers(keep).row;
    const std::vector<std::uint8_t> out =
        contradicted(exec, in, gather_rows(exec, object, rows), gather_column(exec, seen, 1, rows));
    std::vector<std::uint8_t> fewer = keep;
    for (std::size_t r = 0; r < rows.size(); ++r) fewer[std::size_t(rows[r])] = !out[r];
    const std::int64_t count = std::ranges::count(out, std::uint8_t(1));
    const std::int64_t now = count > 0 ? wrong_pixels(exec, in, object, fewer) : wrong;
    if (count == 0 || now > wrong) break;
    keep = std::move(fewer);
    dropped += count;
    wrong = now;
  }
  return dropped;
}

}  // namespace ngs::finish
