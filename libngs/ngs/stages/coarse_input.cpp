#include "ngs/stages/coarse_input.h"

#include "ngs/scene/shrink.h"

namespace ngs {
namespace {

constexpr std::size_t kKeptBytes = 512u << 20;

std::vector<float> plane_means(std::vector<float> plane, const ViewMasks& masks, int shrink) {
  ImageF fine;
  fine.width_px = masks.width_px, fine.height_px = masks.height_px, fine.channels = 1;
  fine.data = std::move(plane);
  return shrunk(fine, shrink).data;
}

Scene with_shrunk_cameras(Scene scene, int shrink) {
  for (SceneView& view : scene.views) view.camera = shrunk(view.camera, shrink);
  return scene;
}

}  // namespace

CoarseInput::CoarseInput(const MethodInput& fine, int shrink)
    : fine_(fine),
      shrink_(shrink),
      scene_(with_shrunk_cameras(fine.scene, shrink)),
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
  ImageF image = shrunk(fine_.load_photo(view), shrink_);
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
    m.width_px = shrunk_size_px(m.width_px, shrink_), m.height_px = shrunk_size_px(m.height_px, shrink_);
  }
  if (keep(m.target.size() * (m.target.empty() ? 0 : m.target[0].size()))) masks_[view] = m;
  return m;
}

}  // namespace ngs
