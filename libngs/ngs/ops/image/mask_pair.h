#pragma once
// A pair of a rendered mask and the given mask of the same view, for measures of their agreement.
#include <algorithm>
#include <vector>

#include "ngs/ops/image/metrics.h"
#include "ngs/scene/mask_threshold.h"
#include "ngs/scene/scene.h"

namespace ngs {

/// 0/1 plane of the foreground of a mask.
inline std::vector<std::uint8_t> object_pixels(const std::vector<float>& target) {
  std::vector<std::uint8_t> plane(target.size());
  for (std::size_t p = 0; p < plane.size(); ++p) plane[p] = mask_is_foreground(target[p]);
  return plane;
}

/// A bounding box of pixels [x0, x1) x [y0, y1).
struct ForegroundBox {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  bool empty() const { return x0 >= x1; }
  void add(int x, int y) { *this = empty() ? ForegroundBox{x, y, x + 1, y + 1} : joined({x, y, x + 1, y + 1}); }
  void add(const ForegroundBox& other) {
    if (!other.empty()) *this = empty() ? other : joined(other);
  }

 private:
  ForegroundBox joined(const ForegroundBox& o) const {
    return {std::min(x0, o.x0), std::min(y0, o.y0), std::max(x1, o.x1), std::max(y1, o.y1)};
  }
};

/// The foreground box of each object in `label` [H, W, K], in one pass for all objects.
inline std::vector<ForegroundBox> foreground_boxes(const ImageF& label) {
  const auto objects = std::size_t(label.channels);
  std::vector<ForegroundBox> boxes(objects);
  for (int y = 0; y < label.height_px; ++y)
    for (int x = 0; x < label.width_px; ++x) {
      const float* at = &label.data[label.index(x, y)];
      for (std::size_t k = 0; k < objects; ++k)
        if (label_is_foreground(at[k])) boxes[k].add(x, y);
    }
  return boxes;
}

/// The box of the pixels of an image [h, w] for whose index is_in(index).
template <class IsIn>
ForegroundBox box_where(int w, int h, const IsIn& is_in) {
  ForegroundBox box;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      if (is_in(std::size_t(y) * std::size_t(w) + std::size_t(x))) box.add(x, y);
  return box;
}
/// The box of the pixels above 0 in a plane [h, w].
inline ForegroundBox foreground_box(const std::vector<float>& plane, int w, int h) {
  return box_where(w, h, [&](std::size_t p) { return plane[p] > 0.f; });
}

/// Pixels in both of two masks, and in either.
struct MaskOverlap {
  std::int64_t both = 0, either = 0;
  void add(bool a, bool b) {
    both += a && b;
    either += a || b;
  }
  /// IoU; 1 if both masks are empty.
  double iou() const { return either > 0 ? double(both) / double(either) : 1; }
};

/// 0/1 planes of one object, cropped to the box in which either mask contains it. Pixels of unknown mask are 0 in both.
struct MaskPair {
  ForegroundBox at;
  int view_width_px, view_height_px;
  std::vector<std::uint8_t> rendered, own;

  /// `label` [H, W, K]: the rendered labels. `shown`: a box of all pixels where object k is label_is_foreground().
  MaskPair(const ImageF& label, const ViewMasks& masks, std::size_t k, const ForegroundBox& shown)
      : at(shown), view_width_px(masks.width_px), view_height_px(masks.height_px) {
    const std::vector<float>& target = masks.target[k];
    at.add(box_where(view_width_px, view_height_px, [&](std::size_t p) { return mask_is_foreground(target[p]); }));
    rendered.reserve(std::size_t(width_px()) * std::size_t(height_px()));
    own.reserve(rendered.capacity());
    for (int y = at.y0; y < at.y1; ++y)
      for (int x = at.x0; x < at.x1; ++x) {
        const std::size_t p = pixel(x, y);
        const bool known = masks.known.empty() || masks.known[p];
        rendered.push_back(known && label_is_foreground(label.data[label.index(x, y, int(k))]));
        own.push_back(known && mask_is_foreground(target[p]));
      }
  }

  /// Counts within the box: true negatives outside it are missing.
  Confusion counts(const Exec& exec) const { return confusion(exec, plane(rendered), plane(own)); }
  /// Boundary IoU, band 2 % of the view's diagonal.
  double biou(const Exec& exec) const {
    return boundary_iou(exec, chessboard_distance(plane(rendered)), chessboard_distance(plane(own)), width_px(),
                        band_width_px(0.02, view_width_px, view_height_px));
  }

 private:
  int width_px() const { return at.x1 - at.x0; }
  int height_px() const { return at.y1 - at.y0; }
  std::size_t pixel(int x, int y) const { return std::size_t(y) * std::size_t(view_width_px) + std::size_t(x); }
  MaskPlane plane(const std::vector<std::uint8_t>& mask) const { return {mask.data(), width_px(), height_px()}; }
};

}  // namespace ngs
