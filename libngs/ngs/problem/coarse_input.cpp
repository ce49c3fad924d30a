#include "ngs/problem/coarse_input.h"

#include <algorithm>
#include <atomic>

#include "ngs/backend/for_each.h"
#include "ngs/problem/view_list.h"
#include "ngs/scene/resize.h"

namespace ngs {
namespace {

std::size_t bytes_of(const PackedPhoto& photo) { return photo.bytes(); }
std::size_t bytes_of(const RleMasks& masks) { return masks.bytes(); }

std::vector<float> plane_means(std::vector<float> plane, const ViewMasks& masks, int shrink) {
  ImageF fine;
  fine.width_px = masks.width_px;
  fine.height_px = masks.height_px;
  fine.channels = 1;
  fine.data = std::move(plane);
  return shrunk(fine, shrink).data;
}

Scene with_shrunk_cameras(Scene scene, int shrink) {
  for (SceneView& view : scene.views) view.camera = shrunk(view.camera, shrink);
  return scene;
}

}  // namespace

CoarseInput::CoarseInput(const Problem& fine, int shrink, std::size_t cache_bytes)
    : fine_(fine),
      shrink_(shrink),
      scene_(with_shrunk_cameras(fine.scene, shrink)),
      coarse_(fine.with_views(
          scene_, [this](std::size_t view) { return masks(view); }, [this](std::size_t view) { return photo(view); })),
      cache_bytes_(cache_bytes) {
  coarse_.splat = filter_at_scale(fine.splat, 1.0 / shrink);
}

template <class T, class Load>
std::shared_ptr<const T> CoarseInput::cached(Cached<T>& cache, std::size_t view, const Load& load) {
  {
    const std::lock_guard lock(mutex_);
    const auto known = cache.find(view);
    if (known != cache.end()) return known->second;
  }
  auto loaded = std::make_shared<const T>(load());
  const std::lock_guard lock(mutex_);
  const std::size_t bytes = bytes_of(*loaded);
  if (bytes_ + bytes <= cache_bytes_ && cache.emplace(view, loaded).second) bytes_ += bytes;
  return loaded;
}

ImageF CoarseInput::photo(std::size_t view) {
  return cached(photos_, view, [&] { return PackedPhoto(shrunk(fine_.load_photo(view), shrink_)); })->rgb();
}

ViewMasks CoarseInput::masks(std::size_t view) {
  return cached(masks_, view, [&] { return RleMasks(load_masks(view)); })->unpacked();
}

ViewMasks CoarseInput::load_masks(std::size_t view) const {
  ViewMasks m = fine_.load_masks(view);
  if (shrink_ == 1 || !m.available) return m;
  for (std::vector<float>& target : m.target) target = plane_means(std::move(target), m, shrink_);
  if (!m.known.empty()) {
    const std::vector<float> share = plane_means({m.known.begin(), m.known.end()}, m, shrink_);
    m.known.assign(share.size(), 0);
    for (std::size_t i = 0; i < share.size(); ++i) m.known[i] = share[i] == 1.f;
  }
  m.width_px = shrunk_size_px(m.width_px, shrink_);
  m.height_px = shrunk_size_px(m.height_px, shrink_);
  return m;
}

double CoarseInput::preload(const Exec& exec, const std::function<bool()>& keep_loading) const {
  std::atomic<std::int64_t> excluded = 0;
  const std::vector<std::size_t> photos = photo_views(scene_);
  const auto masks = std::int64_t(coarse_.views.size()), all = masks + std::int64_t(photos.size());
  for_each_task(exec, all, [&](std::int64_t i) {
    {
      const std::lock_guard lock(mutex_);
      if (bytes_ > cache_bytes_ / 10 * 9) return;  // another image would not fit into the cache
    }
    if (stop_requested(fine_.monitor) || (keep_loading && !keep_loading())) {
      ++excluded;
      return;
    }
    if (i < masks)
      coarse_.load_masks(coarse_.views[std::size_t(i)]);
    else
      coarse_.load_photo(photos[std::size_t(i - masks)]);
  });
  return all > 0 ? 1 - double(excluded) / double(all) : 1;
}

void CoarseInput::clear_cache() {
  const std::lock_guard lock(mutex_);
  photos_.clear();
  masks_.clear();
  cache_bytes_ = bytes_ = 0;
}

int decision_shrink(const Scene& scene) {
  int longest_px = 0;
  for (const SceneView& view : scene.views)
    longest_px = std::max({longest_px, view.camera.width_px, view.camera.height_px});
  return longest_px >= 512 ? 2 : 1;
}

}  // namespace ngs
