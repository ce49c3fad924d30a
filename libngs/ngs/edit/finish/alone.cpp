#include "ngs/edit/finish/alone.h"

#include <algorithm>
#include <cmath>

#include "ngs/core/check.h"
#include "ngs/math/row_numbers.h"
#include "ngs/ops/image/metrics.h"
#include "ngs/ops/splat/evidence.h"
#include "ngs/problem/cloud_rows.h"
#include "ngs/scene/view_prompt.h"

namespace ngs::finish {
namespace {

constexpr int kRounds = 2;  // what is left out uncovers Gaussians behind it
// Of a Gaussian's weight within the mask: with more outside it is contradicted. The second is for weight that other
// things hide in the scene: an unseen side may be there as well as haze.
constexpr double kOutsideTimes = 1, kHiddenTimes = 10;

constexpr int kLeast_px = 3;  // what masks lack less of, the margins of SupportView cover
constexpr int kMost_px = 8;
constexpr int kFar_px = 12;        // here the surroundings begin
constexpr double kOutside = 0.85;  // of the change within
constexpr double kFarTimes = 2;    // the change of the surroundings

/// Length of the photo's gradient, summed over the channels; not at the image's border.
double change_at(const ImageF& photo, int x, int y) {
  double across = 0, down = 0;
  for (int c = 0; c < photo.channels; ++c) {
    across += std::abs(double(photo.at(x + 1, y, c)) - double(photo.at(x - 1, y, c)));
    down += std::abs(double(photo.at(x, y + 1, c)) - double(photo.at(x, y - 1, c)));
  }
  return std::hypot(across, down);
}

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
    out.wrong += view.wrong_pixels(out.seen.back());
  }
  return out;
}

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
    if (now.wrong > alone.wrong) return;
    alone = std::move(now);
  }
}

void MaskLack::add(const std::vector<GivenMask>& mask, const ImageF& photo) {
  const int w = photo.width_px, h = photo.height_px;
  NGS_CHECK(mask.size() == std::size_t(w) * std::size_t(h), "a photo has the size of its mask");
  PixelMask object(mask.size());
  for (std::size_t p = 0; p < mask.size(); ++p) object[p] = mask[p] == GivenMask::kObject;
  const std::vector<std::int32_t> inside = signed_distance({object.data(), w, h});
  for (int y = 1; y + 1 < h; ++y)
    for (int x = 1; x + 1 < w; ++x) {
      const std::size_t p = std::size_t(y) * std::size_t(w) + std::size_t(x);
      if (inside[p] < -kOutside_px || inside[p] > kInside_px || mask[p] == GivenMask::kUnknown) continue;
      const auto at = std::size_t(inside[p] + kOutside_px);
      change_[at] += change_at(photo, x, y);
      ++pixels_[at];
    }
}

int MaskLack::px() const {
  double within = 0, outside = 0;  // the largest mean change up to a pixel outside of the contour, and farther outside
  double far = 0;
  std::int64_t far_pixels = 0;
  int lack = 0;
  for (int inside = kInside_px; inside >= -kOutside_px; --inside) {
    const auto at = std::size_t(inside + kOutside_px);
    const double mean = pixels_[at] > 0 ? change_[at] / double(pixels_[at]) : 0;
    if (inside >= -1) {
      within = std::max(within, mean);
    } else if (inside <= -kFar_px) {
      far += change_[at];
      far_pixels += pixels_[at];
    } else if (inside <= -kLeast_px && inside >= -kMost_px && mean > outside) {
      outside = mean;
      lack = -inside;
    }
  }
  if (outside <= kOutside * within) return 0;
  return outside * double(far_pixels) > kFarTimes * far ? lack : 0;
}

}  // namespace ngs::finish
