#pragma once
// The body of photometric.h; included by the gradient test as well, which instantiates it for Dual.
#include <algorithm>

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/losses/photometric.h"
#include "ngs/ops/losses/photometric_strips.h"
#include "ngs/ops/optim/resident.h"

namespace ngs {

namespace detail {

/// Σ of the weights of the pixels in the box; their number without weights.
inline double total_weight(const ImageF* weight, const PixelRect& of) {
  if (!weight) return double(of.x1 - of.x0) * (of.y1 - of.y0);
  double sum = 0;
  for (int y = of.y0; y < of.y1; ++y)
    for (int x = of.x0; x < of.x1; ++x) sum += double(weight->at(x, y));
  return sum;
}

}  // namespace detail

template <class T, class Acc>
auto PhotometricPass<T, Acc>::evaluate(const Exec& exec, const PhotometricOptions& options, const Images& in,
                                       Image<T>* gradient) -> Value {
  const auto& [rendered, target, weight] = in;
  const int w = rendered.width_px, h = rendered.height_px, channels = rendered.channels;
  NGS_CHECK(w == target.width_px && h == target.height_px && channels == target.channels,
            "photometric: rendered and target differ in size");
  NGS_CHECK(!weight || (weight->width_px == w && weight->height_px == h && weight->channels == 1),
            "photometric: the weight image has another size");
  const bool resized =
      gradient && (gradient->width_px != w || gradient->height_px != h || gradient->channels != channels);
  if (resized) *gradient = Image<T>(w, h, channels);
  const auto clear = [&] {
    if (gradient && !resized) fill_zero(exec, gradient->data);
  };

  const PixelRect full{0, 0, w, h};
  const PixelRect inner = options.box.empty() ? full : options.box;
  NGS_CHECK(inner.x0 >= 0 && inner.y0 >= 0 && inner.x1 <= w && inner.y1 <= h, "photometric: box outside the image");
  // Windows of pixels inside extend kRadius further; pixels beyond have no influence.
  const int x0 = std::max(0, inner.x0 - ssim::kRadius), y0 = std::max(0, inner.y0 - ssim::kRadius);
  const ssim::Layout layout{std::min(w, inner.x1 + ssim::kRadius) - x0, std::min(h, inner.y1 + ssim::kRadius) - y0,
                            channels};

  const double weight_sum = options.weight_sum > 0 ? options.weight_sum : detail::total_weight(weight, inner);
  if (!(weight_sum > 0)) return clear(), Value{Acc(0), Acc(0), Acc(1)};
  if (!options.box.empty()) clear();
  const double norm = 1.0 / (weight_sum * channels);
  const std::int64_t stride = std::int64_t(w) * channels;
  return compare(exec,
                 {layout,
                  {rendered.data.data() + rendered.index(x0, y0), stride},
                  {target.data.data() + target.index(x0, y0), stride},
                  {{weight ? weight->data.data() + weight->index(x0, y0) : nullptr, w},
                   inner.x0 - x0,
                   inner.x1 - x0,
                   inner.y0 - y0,
                   inner.y1 - y0},
                  -options.gradient_scale * options.dssim_weight * norm,
                  options.gradient_scale * (1 - options.dssim_weight) * norm,
                  {gradient ? gradient->data.data() + gradient->index(x0, y0) : nullptr, stride}},
                 options.dssim_weight, norm);
}

template <class T, class Acc>
auto PhotometricPass<T, Acc>::compare(const Exec& exec, const ssim::Comparison<T>& c, double dssim_weight, double norm)
    -> Value {
  const auto value = [&](Acc l1, Acc similarity) -> Value {
    l1 = l1 * Acc(norm);
    similarity = similarity * Acc(norm);
    return {Acc(1 - dssim_weight) * l1 + Acc(dssim_weight) * (Acc(1) - similarity), l1, similarity};
  };
  if constexpr (std::is_same_v<T, float>)
    if (exec.device_ops) {
      const auto sums = exec.device_ops->loss.photometric(c);
      return value(sums.l1, sums.ssim);
    }
  const bool wants_gradient = c.gradient.first != nullptr;
  const ssim::StripPlan plan{c.layout};
  const ssim::Window<T> window;
  if (wants_gradient) partials_.resize(std::max(partials_.size(), std::size_t(c.layout.plane()) * ssim::kPartials));
  sums_.resize(std::size_t(plan.size()) * 2);
  for_each_task(exec, plan.size(),
                ssim::BandLoss<T, Acc>{c.layout, window, c.x, c.y, c.weights, T(c.ssim_factor),
                                       wants_gradient ? partials_.data() : nullptr, sums_.data()});
  if (wants_gradient)
    for_each_task(
        exec, plan.size(),
        ssim::BandGradient<T>{c.layout, window, c.x, c.y, c.weights, T(c.l1_factor), partials_.data(), c.gradient});
  Acc l1 = Acc(0), similarity = Acc(0);
  for (std::size_t task = 0; task < sums_.size(); task += 2) {
    l1 += sums_[task];
    similarity += sums_[task + 1];
  }
  return value(l1, similarity);
}

}  // namespace ngs
