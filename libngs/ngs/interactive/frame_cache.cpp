#include "ngs/interactive/frame_cache.h"

#include <algorithm>

#include "ngs/backend/for_each.h"
#include "ngs/cut/masks/rasterise_prompt.h"
#include "ngs/edit/select/touched_pieces.h"
#include "ngs/ops/image/image_bytes.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs::live {
namespace {

/// Channels [N, 2] of the Gaussians `rows`: the object's share of the weight, and 1 if the Gaussian has evidence.
std::vector<float> known_channels(const Exec& exec, const WeightSums<>& sums, const std::vector<std::uint32_t>& rows) {
  std::vector<float> channel(2 * std::size_t(sums.gaussians));
  for_each_index(exec, std::ssize(rows), [&](std::int64_t v) {
    const std::size_t row = rows[std::size_t(v)];
    if (sums.weight.value(row) > 0) channel[2 * row] = float(sums.prob(row, 0)), channel[2 * row + 1] = 1;
  });
  return channel;
}

/// Selection from a render of known_channels(): at least half of the pixel is known (empty counts as known background),
/// and most of the known part is the object.
PixelMask selection_of(const RenderedView& rendered) {
  PixelMask selection(rendered.alpha.data.size());
  for (std::size_t p = 0; p < selection.size(); ++p) {
    const float known = rendered.label.data[2 * p + 1] + 1 - rendered.alpha.data[p];
    selection[p] = known >= 0.5f && label_is_foreground(rendered.label.data[2 * p] / known);
  }
  return selection;
}

}  // namespace

CachedFrame::CachedFrame(const Exec& exec, const Model& model, const Viewpoint& viewpoint, const Camera& camera)
    : exec_(exec), model_(model), viewpoint_(viewpoint), cached_view_(exec, model.cloud, camera, model.splat) {}

/// Renders the picture unless it is cached, and the selection by `channel` unless that is empty.
void CachedFrame::draw(const std::vector<float>& channel) {
  RenderRequest request;
  request.colour = picture_.empty(), request.background = model_.background;
  if (!channel.empty()) request.label = {channel.data(), model_.cloud.size(), 2};
  const RenderedView rendered = cached_view_.render(exec_, request);
  if (request.colour) picture_ = to_bytes(rendered.colour), alpha_ = rendered.alpha.data;
  if (!channel.empty()) selection_ = selection_of(rendered);
}

const ImageU8& CachedFrame::picture() {
  if (picture_.empty()) draw({});
  return picture_;
}

const std::vector<float>& CachedFrame::alpha() { return picture(), alpha_; }

const PixelMask& CachedFrame::selection(const WeightSums<>& sums, const MarkedViews& others) {
  if (!has_selection(others)) draw(known_channels(exec_, sums, cached_view_.rows()));
  others_ = others;
  return selection_;
}

void CachedFrame::weigh(MarkedView& view) {
  view.touched.clear();
  for (const PixelMask& stroke : object_strokes(rasterise(view.strokes, view.camera.width_px, view.camera.height_px)))
    view.touched.push_back(cached_view_.weigh(exec_, stroke).weights_inside(0));
  const ViewSums& sums = cached_view_.weigh(exec_, view.mask);
  if (!view.seen) view.seen = std::make_shared<const ViewSums>(sums.weights());
  view.inside = sums.weights_inside(0);
}

CachedFrame& FrameCache::of(const Viewpoint& viewpoint, const Camera& camera) {
  const auto found =
      std::find_if(views_.begin(), views_.end(), [&](const auto& view) { return view->viewpoint() == viewpoint; });
  if (found != views_.end()) {
    std::rotate(views_.begin(), found, found + 1);
  } else {
    if (views_.size() == kMaxFrames) views_.pop_back();  // frees its memory for the next one
    views_.insert(views_.begin(), std::make_unique<CachedFrame>(exec_, model_, viewpoint, camera));
  }
  return *views_.front();
}

}  // namespace ngs::live
