#pragma once
// A rendered mask beside the view's own: what every measure of their agreement starts from.
#include <vector>

#include "ngs/ops/image/metrics.h"
#include "ngs/scene/mask_threshold.h"
#include "ngs/scene/scene.h"

namespace ngs {

/// 0/1 plane of what a mask gives to its object.
inline std::vector<std::uint8_t> object_pixels(const std::vector<float>& target) {
  std::vector<std::uint8_t> plane(target.size());
  for (std::size_t p = 0; p < plane.size(); ++p) plane[p] = mask_says_object(target[p]);
  return plane;
}

/// 0/1 planes of one object in one view; pixels of unknown mask are 0 in both.
struct MaskPair {
  int width_px, height_px;
  std::vector<std::uint8_t> rendered, own;

  /// `label` [H, W, K] as rendered: object k where label_says_object().
  MaskPair(const ImageF& label, const ViewMasks& masks, std::size_t k)
      : width_px(masks.width_px), height_px(masks.height_px) {
    const auto channels = std::size_t(label.channels);
    for (std::size_t p = 0; p < masks.target[k].size(); ++p) {
      const bool known = masks.known.empty() || masks.known[p];
      rendered.push_back(known && label_says_object(label.data[p * channels + k]));
      own.push_back(known && mask_says_object(masks.target[k][p]));
    }
  }

  Confusion counts(const Exec& exec) const { return confusion(exec, plane(rendered), plane(own)); }
  /// Boundary IoU, band 2 % of the diagonal.
  double biou(const Exec& exec) const {
    return boundary_iou(exec, chessboard_distance(plane(rendered)), chessboard_distance(plane(own)), width_px,
                        band_width_px(0.02, width_px, height_px));
  }

 private:
  MaskPlane plane(const std::vector<std::uint8_t>& mask) const { return {mask.data(), width_px, height_px}; }
};

}  // namespace ngs
