#pragma once
// A scene folder as people have it: COLMAP text, JPEG photos, label maps, a splat.
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
  ImageU8 label;  // one channel: ids, 0 is nobody's
};

/// Views of the same picture share one file on the disk.
struct WrittenView {
  Camera camera;
  std::size_t picture = 0;
};

/// Writes `folder`/point_cloud.ply, sparse/0, images and masks_label; `picture` is asked once for each that is used.
void write_scene(const std::string& folder, const GaussianCloud& cloud, const std::vector<WrittenView>& views,
                 const std::function<LabelledPhoto(std::size_t picture)>& picture);

/// Name of view number `index`, which sorts as the number does.
std::string view_name(std::size_t index);

}  // namespace ngs::bench
