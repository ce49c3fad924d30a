#pragma once
// The body of photometric.h; included by the gradient test as well, which instantiates it for Dual.
#include <algorithm>

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/losses/photometric.h"
#include "ngs/ops/losses/photometric_strips.h"

namespace ngs {

template <class T, class Acc>
auto PhotometricPass<T, Acc>::evaluate(const Exec& exec, const PhotometricOptions& options, const Image<T>& rendered,
                                       const Image<T>& target, const ImageF* weight, Image<T>* gradient) -> Value {
  const int W = rendered.width_px, H = rendered.height_px, C = rendered.channels;
  NGS_CHECK(W == target.width_px && H == target.height_px && C == target.channels,
            "photometric: rendered and target differ in size");
  NGS_CHECK(!weight || (weight->width_px == W && weight->height_px == H && weight->channels == 1),
            "photometric: the weight image has another size");
  const bool resized = gradient && (gradient->width_px != W || gradient->height_px != H || gradient->channels != C);
  if (resized) *gradient = Image<T>(W, H, C);
  const auto clear = [&] {
    if (gradient && !resized) std::fill(gradient->data.begin(), gradient->data.end(), T(0));
  };

  const PixelRegion whole{0, 0, W, H};
  const PixelRegion inner = options.region.empty() ? whole : options.region;
  NGS_CHECK(inner.x0 >= 0 && inner.y0 >= 0 && inner.x1 <= W && inner.y1 <= H, "photometric: region outside the image");
  // Windows of pixels inside reach kRadius further; what lies beyond has no influence at all.
  const int x0 = std::max(0, inner.x0 - ssim::kRadius), y0 = std::max(0, inner.y0 - ssim::kRadius);
  const ssim::Layout layout{std::min(W, inner.x1 + ssim::kRadius) - x0, std::min(H, inner.y1 + ssim::kRadius) - y0, C};

  double weight_sum = double(inner.x1 - inner.x0) * (inner.y1 - inner.y0);
  if (weight) {
    weight_sum = 0;
    for (int y = inner.y0; y < inner.y1; ++y)
      for (int x = inner.x0; x < inner.x1; ++x) weight_sum += double(weight->at(x, y));
  }
  if (!(weight_sum > 0)) return clear(), Value{Acc(0), Acc(0), Acc(1)};
  if (!options.region.empty()) clear();
  const double norm = 1.0 / (weight_sum * C);
  const double ssim_factor = -options.gradient_scale * options.dssim_weight * norm,
               l1_factor = options.gradient_scale * (1 - options.dssim_weight) * norm;
  const auto value = [&](Acc l1, Acc similarity) -> Value {
    l1 = l1 * Acc(norm), similarity = similarity * Acc(norm);
    return {Acc(1 - options.dssim_weight) * l1 + Acc(options.dssim_weight) * (Acc(1) - similarity), l1, similarity};
  };

  const std::int64_t stride = std::int64_t(W) * C;
  const ssim::Crop<const T> x{rendered.data.data() + rendered.index(x0, y0), stride};
  const ssim::Crop<const T> y{target.data.data() + target.index(x0, y0), stride};
  const ssim::PixelWeights weights{{weight ? weight->data.data() + weight->index(x0, y0) : nullptr, W},
                                   inner.x0 - x0, inner.x1 - x0, inner.y0 - y0, inner.y1 - y0};
  const ssim::Crop<T> to{gradient ? gradient->data.data() + gradient->index(x0, y0) : nullptr, stride};
  if constexpr (std::is_same_v<T, float>)
    if (exec.device_ops) {
      const auto sums = exec.device_ops->loss.photometric(layout, x, y, weights, ssim_factor, l1_factor, to);
      return value(sums.l1, sums.ssim);
    }
  const ssim::StripPlan plan{layout};
  const ssim::Window<T> window;
  if (gradient) partials_.resize(std::max(partials_.size(), std::size_t(layout.plane()) * ssim::kPartials));
  sums_.resize(std::size_t(plan.size()) * 2);
  for_each_task(exec, plan.size(),
                ssim::BandLoss<T, Acc>{layout, window, x, y, weights, T(ssim_factor),
                                       gradient ? partials_.data() : nullptr, sums_.data()});
  if (gradient)
    for_each_task(exec, plan.size(),
                  ssim::BandGradient<T>{layout, window, x, y, weights, T(l1_factor),
                                        partials_.data(), to});
  Acc l1 = Acc(0), similarity = Acc(0);
  for (std::size_t task = 0; task < sums_.size(); task += 2) l1 += sums_[task], similarity += sums_[task + 1];
  return value(l1, similarity);
}

}  // namespace ngs
