#pragma once
// The images of a view as planes for the compositing kernels. Internal to ops.
#include <vector>

#include "ngs/ops/optim/resident.h"
#include "ngs/ops/splat/splat_engine.h"
#include "ngs/scene/rendered_view.h"

namespace ngs {

/// Request is RenderRequest; a template because splat.h, which defines it, must not be included here.
template <class Request>
ChannelPlan<float> channel_plan(const Request& request) {
  return {request.colour, request.depth, request.label, request.background};
}

/// The planes of a view's images in channel order, `alpha` last.
template <class T, class View>
std::vector<Plane<T>> planes(const ChannelPlan<float>& plan, View& view) {
  std::vector<Plane<T>> out;
  const auto add = [&](auto& image, int channels) {
    for (int c = 0; c < channels; ++c) out.push_back({image.empty() ? nullptr : image.data.data() + c, channels});
  };
  if (plan.colour) add(view.colour, 3);
  if (plan.label.n > 0) add(view.label, plan.label.c);
  if (plan.depth) add(view.depth, 1);
  add(view.alpha, 1);
  return out;
}

/// Gives the images their shapes. Reuses memory of the right shape without clearing it: every pixel is written later.
inline void allocate(const Camera& camera, const ChannelPlan<float>& plan, ResidentResults& images,
                     RenderedView& view) {
  const int w = camera.width_px, h = camera.height_px;
  view.width_px = w;
  view.height_px = h;
  images.shape(view.colour, w, h, plan.colour ? 3 : 0);
  images.shape(view.label, w, h, plan.labels());
  images.shape(view.depth, w, h, plan.depth ? 1 : 0);
  images.shape(view.alpha, w, h, 1);
}
inline void allocate(const Camera& camera, const ChannelPlan<float>& plan, RenderedView& view) {
  ResidentResults on_host({});
  allocate(camera, plan, on_host, view);
}

}  // namespace ngs
