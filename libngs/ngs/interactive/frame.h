#pragma once
// A render of a model with its selection.
#include <array>
#include <memory>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/interactive/marks.h"
#include "ngs/ops/splat/cached/cached_view.h"
#include "ngs/scene/evidence.h"

namespace ngs::live {

// The labels of one object from the sums of its marked views. They are bit-identical to those of ngs-variance and of
// `ngs-joint --method flash` over the same views.

void add_view(const MarkedView& view, WeightSums<>& sums);
void remove_view(const MarkedView& view, WeightSums<>& sums);
/// Replaces a view by another with the same visible Gaussians. Returns the Gaussians whose sums change, ascending.
std::vector<std::uint32_t> replace_view(const MarkedView& before, const MarkedView& now, WeightSums<>& sums);

/// The labels of one object, [N].
struct ObjectLabels {
  std::vector<float> label;            // 1 object, 0 not
  std::vector<std::uint8_t> boundary;  // 1: views disagree (ngs-variance --tau at its default)
  std::int64_t count = 0;              // Gaussians with label 1
  std::int64_t removed = 0;            // Gaussians of pieces that no stroke touches, and needles: label and boundary 0

  static ObjectLabels none(std::size_t gaussians) {
    return {std::vector<float>(gaussians), std::vector<std::uint8_t>(gaussians), 0, 0};
  }
};
/// Updates the labels of `rows`, each listed once, after their sums have changed.
void label_rows(const Exec& exec, const WeightSums<>& sums, const std::vector<std::uint32_t>& rows,
                ObjectLabels& labels);

struct Model {
  const GaussianCloud& cloud;
  SplatOptions splat;  // with `prepared`
  Vec3<float> background{0, 0, 0};
};

struct ShownObject {
  int id = 0;
  std::array<float, 3> colour{1, 0.5f, 0};      // RGB in [0, 1]
  std::shared_ptr<const ObjectLabels> labels;   // null: neither strokes nor edits
  std::shared_ptr<const ObjectLabels> touched;  // of the pieces that strokes touch; with edits: `labels`
  bool hidden = false;                          // its Gaussians are not drawn
};

enum class Layer : std::uint8_t { kBoth, kObject, kBackground, kBoundary };

struct FrameRequest {
  Camera camera;
  Layer layer = Layer::kBoth;
  double fade = 0.5;      // for kBoth: 0 the object alone, 1 the background alone, 0.5 the full model
  int object = 0;         // id; 0: all objects
  bool highlight = true;  // tint the selection and draw its outline
};

/// Cache of the last frame of the full model, reused for the next frame from the same camera. For one model only.
struct CachedStill {
  std::unique_ptr<CachedView> view;
  ImageF colour;  // without the selection
};

/// RGB image. Objects without labels are not shown as selected. The cache `last` (null: none) changes no pixel.
ImageU8 draw_frame(const Exec& exec, const Model& model, const std::vector<ShownObject>& objects,
                   const FrameRequest& request, CachedStill* last = nullptr);

// Cache of the views with the latest strokes, so that the next stroke on them costs only its changes: projected and
// tile-sorted Gaussians, renders, and the selection from the object's other views. All of it can be recomputed.

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
