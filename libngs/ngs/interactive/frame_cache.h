#pragma once
// Cache of the views with the latest strokes, so that the next stroke on them costs only its changes: projected and
// tile-sorted Gaussians, renders, and the selection from the object's other views. All of it can be recomputed.
#include <memory>
#include <vector>

#include "ngs/interactive/frame.h"
#include "ngs/ops/splat/cached/cached_view.h"

namespace ngs::live {

using MarkedViews = std::vector<std::shared_ptr<const MarkedView>>;

class CachedFrame {
 public:
  /// `viewpoint`: the view; `camera`: the same at the segmented size. The model must outlive this object.
  CachedFrame(const Exec& exec, const Model& model, const Viewpoint& viewpoint, const Camera& camera);

  const Viewpoint& viewpoint() const { return viewpoint_; }
  /// As Session::picture(); rendered once.
  const ImageU8& picture();
  /// [H·W] opacity of the model; rendered together with the picture.
  const std::vector<float>& alpha();
  /// The selection in this view by the labels of `others`, whose sums are `sums`. Rendered again only if `others`
  /// differs from the previous call.
  const PixelMask& selection(const WeightSums<>& sums, const MarkedViews& others);
  bool has_selection(const MarkedViews& others) const { return !others.empty() && others == others_; }
  /// Sets the rendering weights of the Gaussians in the view and under its mask and strokes.
  void weigh(MarkedView& view);

 private:
  void draw(const std::vector<float>& channel);

  const Exec& exec_;
  const Model& model_;
  Viewpoint viewpoint_;
  CachedView cached_view_;
  ImageU8 picture_;
  std::vector<float> alpha_;
  MarkedViews others_;
  PixelMask selection_;
};

/// The kMaxFrames latest frames of a model that must outlive this object.
class FrameCache {
 public:
  static constexpr std::size_t kMaxFrames = 2;

  FrameCache(const Exec& exec, const Model& model) : exec_(exec), model_(model) {}
  CachedFrame& of(const Viewpoint& viewpoint, const Camera& camera);

 private:
  const Exec& exec_;
  const Model& model_;
  std::vector<std::unique_ptr<CachedFrame>> views_;  // latest first
};

}  // namespace ngs::live
