#pragma once
// Writes a scene folder as a user would have: COLMAP text, JPEG photos, label maps, a splat.
#include <functional>
#include <string>
#include <vector>

#include "ngs/scene/camera.h"
#include "ngs/scene/gaussian_cloud.h"
#include "ngs/scene/views.h"

namespace ngs::bench {

/// A photo and its label map, both of the camera's size.
struct LabelledPhoto {
  ImageU8 rgb;
  ImageU8 label;  // one channel: object ids, 0: background
};

/// Views with the same picture share one file on disk (hard links).
struct WrittenView {
  Camera camera;
  std::size_t picture = 0;
};

/// Writes `folder`/point_cloud.ply, sparse/0, images and masks_label; calls `picture` once per used picture.
void write_scene(const std::string& folder, const GaussianCloud& cloud, const std::vector<WrittenView>& views,
                 const std::function<LabelledPhoto(std::size_t picture)>& picture);

/// File name of view `index`; names sort by index.
std::string view_name(std::size_t index);

}  // namespace ngs::bench
