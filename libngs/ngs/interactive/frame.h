#pragma once
// A render of a model with its selection.
#include <array>
#include <memory>

#include "ngs/interactive/object_labels.h"
#include "ngs/ops/splat/cached/cached_view.h"

namespace ngs::live {

/// A model that does not change.
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

/// RGB image. Objects without labels are not shown as selected. The cache `last` (null: none) does not change any
/// pixel.
ImageU8 draw_frame(const Exec& exec, const Model& model, const std::vector<ShownObject>& objects,
                   const FrameRequest& request, CachedStill* last = nullptr);

}  // namespace ngs::live
