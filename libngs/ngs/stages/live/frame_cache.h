#pragma once
// The views that were drawn on last, kept so that the next stroke on them costs what it changes: projected and sorted
// into tiles, their pictures, what the object's other views say of them. All of it can be made again from the marks.
#include <memory>
#include <vector>

#include "ngs/ops/splat/cached/cached_view.h"
#include "ngs/stages/live/frame.h"

namespace ngs::live {

using MarkedViews = std::vector<std::shared_ptr<const MarkedView>>;

class CachedFrame {
 public:
  /// `look`, `camera`: what is seen and at which size. The model must outlive it.
  CachedFrame(const Exec& exec, const Model& model, const Look& look, const Camera& camera);

  const Look& look() const { return look_; }
  /// As Session::picture(); drawn once.
  const ImageU8& picture();
  /// [H·W] of the model in it; drawn with the picture.
  const std::vector<float>& alpha();
  /// What `others`, whose sums are `evidence`, select in it, as far as they know; drawn when they are not those of the
  /// call before.
  const PixelMask& selection(const ObjectEvidence& evidence, const MarkedViews& others);
  bool has_selection(const MarkedViews& others) const { return !others.empty() && others == others_; }
  /// Sets what the view's mask and strokes say of the Gaussians.
  void weigh(MarkedView& view);

 private:
  void draw(const std::vector<float>& channel);

  const Exec& exec_;
  const Model& model_;
  Look look_;
  CachedView kept_;
  ImageU8 picture_;
  std::vector<float> alpha_;
  MarkedViews others_;
  PixelMask selection_;
};

/// The last few, of a model that must outlive them.
class FrameCache {
 public:
  static constexpr std::size_t kMost = 2;

  FrameCache(const Exec& exec, const Model& model) : exec_(exec), model_(model) {}
  CachedFrame& of(const Look& look, const Camera& camera);

 private:
  const Exec& exec_;
  const Model& model_;
  std::vector<std::unique_ptr<CachedFrame>> views_;  // the last one first
};

}  // namespace ngs::live
