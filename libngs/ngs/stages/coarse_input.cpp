#include "ngs/stages/coarse_input.h"

#include <algorithm>

namespace ngs {
namespace {

constexpr std::size_t kKeptBytes = 512u << 20;

int cells(int size_px, int shrink) { return (size_px + shrink - 1) / shrink; }

/// Means over shrink x shrink pixels of an interleaved image; cells on the right and lower rim have fewer.
ImageF box_means(const ImageF& fine, int shrink) {
  ImageF mean(cells(fine.width_px, shrink), cells(fine.height_px, shrink), fine.channels);
  for (int y = 0; y < mean.height_px; ++y)
    for (int x = 0; x < mean.width_px; ++x) {
      const int x1 = std::min((x + 1) * shrink, fine.width_px),
                y1 = std::min((y + 1) * shrink, fine.height_px);
      for (int c = 0; c < fine.channels; ++c) {
        double sum = 0;
        for (int v = y * shrink; v < y1; ++v)
          for (int u = x * shrink; u < x1; ++u) sum += double(fine.at(u, v, c));
        mean.at(x, y, c) = float(sum / ((x1 - x * shrink) * (y1 - y * shrink)));
      }
    }
  return mean;
}

std::vector<float> plane_means(std::vector<float> plane, const ViewMasks& masks, int shrink) {
  ImageF fine;
  fine.width_px = masks.width_px, fine.height_px = masks.height_px, fine.channels = 1;
  fine.data = std::move(plane);
  return box_means(fine, shrink).data;
}

Scene shrunk(Scene scene, int shrink) {
  for (SceneView& view : scene.views) {
    Camera& c = view.camera;  // a cell is exactly `shrink` pixels, even where the last one sticks out
    c.fx /= shrink, c.fy /= shrink, c.cx /= shrink, c.cy /= shrink;
    c.width_px = cells(c.width_px, shrink), c.height_px = cells(c.height_px, shrink);
  }
  return scene;
}

}  // namespace

CoarseInput::CoarseInput(const MethodInput& fine, int shrink)
    : fine_(fine),
      shrink_(shrink),
      scene_(shrunk(fine.scene, shrink)),
      coarse_{.cloud = fine.cloud,
              .scene = scene_,
              .views = fine.views,
              .load_masks = [this](std::size_t view) { return masks(view); },
              .load_photo = [this](std::size_t view) { return photo(view); },
              .splat = filter_at_scale(fine.splat, 1.0 / shrink),
              .background = fine.background,
              .seed = fine.seed,
              .fixed = fine.fixed,
              .labels = fine.labels} {}

bool CoarseInput::keep(std::size_t floats) {
  const std::size_t bytes = floats * sizeof(float);
  if (bytes_ + bytes > kKeptBytes) return false;
  bytes_ += bytes;
  return true;
}

ImageF CoarseInput::photo(std::size_t view) {
  const auto known = photos_.find(view);
  if (known != photos_.end()) return known->second;
  ImageF image = fine_.load_photo(view);
  if (shrink_ > 1) image = box_means(image, shrink_);
  if (keep(image.data.size())) photos_[view] = image;
  return image;
}

ViewMasks CoarseInput::masks(std::size_t view) {
  const auto known = masks_.find(view);
  if (known != masks_.end()) return known->second;
  ViewMasks m = fine_.load_masks(view);
  if (shrink_ > 1 && m.available) {
    for (std::vector<float>& target : m.target) target = plane_means(std::move(target), m, shrink_);
    if (!m.known.empty()) {
      const std::vector<float> share = plane_means({m.known.begin(), m.known.end()}, m, shrink_);
      m.known.assign(share.size(), 0);
      for (std::size_t i = 0; i < share.size(); ++i) m.known[i] = share[i] == 1.f;
    }
    m.width_px = cells(m.width_px, shrink_), m.height_px = cells(m.height_px, shrink_);
  }
  if (keep(m.target.size() * (m.target.empty() ? 0 : m.target[0].size()))) masks_[view] = m;
  return m;
}

}  // namespace ngs
