#pragma once
// A model and the photos of its scene.
#include <cstddef>
#include <functional>

#include "ngs/scene/gaussian_cloud.h"
#include "ngs/scene/scene.h"

namespace ngs {

struct PhotographedModel {
  const GaussianCloud& cloud;
  const Scene& scene;  // cameras, filter, renderer
  /// [H, W, 3] RGB in [0, 1] at the camera's size; called by several threads at once.
  std::function<ImageF(std::size_t view)> load_photo;
};

}  // namespace ngs
