#include "planes.h"

#include "ngs/io/image_file.h"
#include "ngs/stages/eval_stage.h"

namespace ngs::cli {

Plane read_plane(const std::string& path, std::uint32_t id) {
  if (path.empty() || path.ends_with(".exr")) return {};
  const io::RawMask raw = io::read_mask_raw(path, id == 0 ? io::Palette::kMask : io::Palette::kIndices);
  const MaskSamples samples = raw.samples();
  Plane plane{raw.width_px, raw.height_px, {}};
  if (id == 0 || (id != 255 && is_black_and_white(samples))) {
    plane.data = binarised(samples, 128);
    return plane;
  }
  plane.data.reserve(raw.data.size());
  for (std::uint32_t label : label_ids(samples)) plane.data.push_back(label == id);
  return plane;
}

Plane fitted(const Plane& plane, int width_px, int height_px) {
  if (plane.empty() || (plane.width_px == width_px && plane.height_px == height_px)) return plane;
  return {width_px, height_px,
          resized_nearest(plane.data.data(), plane.width_px, plane.height_px, width_px, height_px)};
}

}  // namespace ngs::cli
