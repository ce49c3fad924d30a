#pragma once
// Lists of views: of a scene, of a split, in an order.
#include <algorithm>
#include <string>
#include <vector>

#include "ngs/core/error.h"
#include "ngs/core/monitor.h"
#include "ngs/core/rng.h"
#include "ngs/scene/scene.h"

namespace ngs {

inline bool stop_requested(const Monitor* monitor) { return monitor != nullptr && monitor->stop_requested(); }

/// Calls f(n, views[n]) in order and reports progress to `monitor`, which may be null. False: a stop was requested, and
/// the remaining views were skipped, so the caller's result is incomplete.
template <class F>
bool for_each_view(Monitor* monitor, const std::vector<std::size_t>& views, const F& f) {
  for (std::size_t n = 0; n < views.size(); ++n) {
    if (stop_requested(monitor)) return false;
    f(n, views[n]);
    if (monitor != nullptr) monitor->progress(std::int64_t(n) + 1, std::int64_t(views.size()));
  }
  return true;
}

inline std::vector<Camera> cameras_of(const Scene& scene, const std::vector<std::size_t>& views) {
  std::vector<Camera> cameras;
  for (const std::size_t view : views) cameras.push_back(scene.views[view].camera);
  return cameras;
}

/// Indices of the scene's training views: excludes the held-out views.
inline std::vector<std::size_t> training_views(const Scene& scene) {
  std::vector<std::size_t> views;
  for (std::size_t v = 0; v < scene.views.size(); ++v)
    if (scene.views[v].split == Split::kTrain) views.push_back(v);
  return views;
}

/// The scene with only the named objects, in the order of the scene; without names all. Throws kUsage for an unknown
/// name.
inline Scene with_objects(Scene scene, const std::vector<std::string>& names) {
  if (names.empty()) return scene;
  for (const std::string& name : names)
    if (std::ranges::find(scene.objects, name, &SceneObject::name) == scene.objects.end())
      throw Error(ErrorCode::kUsage, "the scene has no object '" + name + "'",
                  "it has " + std::to_string(scene.objects.size()) + " objects, the first is '" +
                      scene.objects.front().name + "'");
  std::erase_if(scene.objects, [&](const SceneObject& o) { return std::ranges::find(names, o.name) == names.end(); });
  return scene;
}

/// Indices of all views of the scene that have a photo, including held-out views.
inline std::vector<std::size_t> photo_views(const Scene& scene) {
  std::vector<std::size_t> views;
  for (std::size_t v = 0; v < scene.views.size(); ++v)
    if (!scene.views[v].image_path.empty()) views.push_back(v);
  return views;
}

/// Number of these views that have a photo.
inline std::size_t photo_count(const Scene& scene, const std::vector<std::size_t>& views) {
  return std::size_t(
      std::count_if(views.begin(), views.end(), [&](std::size_t v) { return !scene.views[v].image_path.empty(); }));
}

/// At most `max_count` of the views, evenly spread.
inline std::vector<std::size_t> spread_views(const std::vector<std::size_t>& views, std::size_t max_count) {
  std::vector<std::size_t> some;
  const std::size_t count = std::min(max_count, views.size());
  for (std::size_t i = 0; i < count; ++i) some.push_back(views[i * views.size() / count]);
  return some;
}

/// The views in random order, by the seed and the number of the pass over the views. The joint steps have an order of
/// their own: JointTrainer::Impl::view_of().
inline std::vector<std::size_t> shuffled(std::vector<std::size_t> views, std::uint64_t seed, std::uint64_t pass) {
  const auto rank = [&](std::size_t view) { return rng_bits(seed, RngStream::kViewOrder, (pass << 32) + view); };
  std::sort(views.begin(), views.end(), [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
  return views;
}

}  // namespace ngs
