#pragma once
// One picture of a model with what is selected on it.
#include <array>
#include <memory>

#include "ngs/ops/splat/cached/cached_view.h"
#include "ngs/stages/live/object_evidence.h"

namespace ngs::live {

/// A model that does not change.
struct Model {
  const GaussianCloud& cloud;
  SplatOptions splat;  // with `prepared`
  Vec3<float> background{0, 0, 0};
};

struct ShownObject {
  int id = 0;
  std::array<float, 3> colour{1, 0.5f, 0};  // RGB in [0, 1]
  std::shared_ptr<const ObjectLabels> labels;
};

enum class Layer : std::uint8_t { kBoth, kObject, kBackground, kBoundary };

struct FrameRequest {
  Camera camera;
  Layer layer = Layer::kBoth;
  double fade = 0.5;      // of kBoth: 0 the object alone, 1 the background alone, 0.5 all of the model
  int object = 0;         // id; 0: all objects
  bool highlight = true;  // tint the selection and draw its outline
};

/// What the last frame of the whole model was made of, for the next one from the same camera: of one model alone.
struct LastFrame {
  std::unique_ptr<CachedView> view;
  ImageF colour;  // without the selection
};

/// RGB. Objects without labels are not shown as selected. `last` (null: none) saves work and changes no pixel.
ImageU8 draw_frame(const Exec& exec, const Model& model, const std::vector<ShownObject>& objects,
                   const FrameRequest& request, LastFrame* last = nullptr);

}  // namespace ngs::live
