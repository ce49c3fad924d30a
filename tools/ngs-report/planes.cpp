#include "planes.h"

#include "ngs/eval/eval_stage.h"
#include "ngs/io/image/image_file.h"

namespace ngs::cli {

Plane read_plane(const std::string& path, std::uint32_t id) {
  if (path.empty() || path.ends_with(".exr")) return {};
  const io::RawMask raw = io::read_mask_raw(path, id == 0 ? io::Palette::kMask : io::Palette::kIndices);
  const MaskSamples samples = raw.samples();
  Plane plane{raw.width_px, raw.height_px, {}, {}};
  if (id == 0 || (id != 255 && is_black_and_white(samples))) {
    plane.data = binarised(samples, kMaskThreshold);
    return plane;
  }
  plane.data.reserve(raw.data.size());
  for (std::uint32_t label : label_ids(samples)) plane.data.push_back(label == id);
  return plane;
}

Plane read_truth(const ShownView& view) {
  Plane truth = read_plane(view.truth, view.truth_id);
  if (truth.empty() || view.truth_id == 0 || view.void_id < 0) return truth;
  const io::RawMask raw = io::read_mask_raw(view.truth, io::Palette::kIndices);
  for (std::uint32_t label : label_ids(raw.samples())) truth.is_void.push_back(std::int64_t(label) == view.void_id);
  return truth;
}

Plane closest_truth(Plane truth, const Plane& predicted) {
  for (std::size_t i = 0; i < truth.is_void.size(); ++i)
    if (truth.is_void[i]) truth.data[i] = predicted.data[i];
  return truth;
}

Plane fitted(const Plane& plane, int width_px, int height_px) {
  if (plane.empty() || (plane.width_px == width_px && plane.height_px == height_px)) return plane;
  const auto resized = [&](const std::vector<std::uint8_t>& data) {
    return resized_nearest(data.data(), plane.width_px, plane.height_px, width_px, height_px);
  };
  return {width_px, height_px, resized(plane.data), plane.is_void.empty() ? plane.is_void : resized(plane.is_void)};
}

}  // namespace ngs::cli
