#pragma once
// The tiny scene as a capture with photos and masks, for tests of check_scene().
#include <doctest/doctest.h>

#include <cmath>

#include "ngs/capture/scene_check.h"
#include "ngs/core/error.h"
#include "support/error_code.h"
#include "support/quiet.h"
#include "support/tiny_scene.h"

namespace ngs::test {

struct Capture {
  Scene scene;
  GaussianCloud cloud;
  std::vector<ImageF> photos;
  std::vector<ViewMasks> masks;

  SceneLoaders loaders() const {
    return {[this](std::size_t view) { return photos.at(view); },
            [this](std::size_t view) {
              return MaskSample{masks.at(view), {}, false};
            }};
  }
  SceneCheck check(SceneCheckOptions options = {}, int threads = 1) const {
    return check_scene(Exec{Device::kCpu, threads}, Quiet(), options, {&cloud, scene, loaders()});
  }
};

/// The tiny scene with photos rendered from it, over a background that is not in the PLY. One quarter of the wall is
/// dark: the ball and the plain wall would look the same upside down.
inline Capture tiny_capture() {
  const TinyScene tiny = tiny_scene();
  Capture capture;
  capture.cloud = tiny.cloud;
  for (std::size_t i = 0; i < capture.cloud.usable.size(); ++i)
    if (tiny.is_object[i] == 0 && capture.cloud.position[i * 3] > 0 && capture.cloud.position[i * 3 + 1] > 0)
      for (std::size_t c = 0; c < 3; ++c) capture.cloud.sh_dc[i * 3 + c] = -1.5f;
  classify(capture.cloud);
  capture.scene.objects = {{"ball", 0}};
  for (const Camera& camera : tiny.cameras) {
    capture.scene.views.push_back({camera, "photo", "mask"});
    RenderRequest request{.label = {tiny.is_object.data(), tiny.cloud.size(), 1}, .background = {0.2f, 0.9f, 0.4f}};
    const RenderedView rendered = render({}, capture.cloud, camera, {}, request);
    capture.photos.push_back(rendered.colour);
    ViewMasks masks{camera.width_px, camera.height_px, {rendered.label.data}, {}, true};
    for (float& m : masks.target[0]) m = m > 0.5f ? 1.f : 0.f;
    capture.masks.push_back(masks);
  }
  return capture;
}

/// The capture in other length units.
inline Capture shrunk(double factor) {
  Capture capture = tiny_capture();
  for (SceneView& view : capture.scene.views) view.camera.translation = factor * view.camera.translation;
  for (float& x : capture.cloud.position) x *= float(factor);
  for (float& s : capture.cloud.log_scale) s += float(std::log(factor));
  return capture;
}

}  // namespace ngs::test
