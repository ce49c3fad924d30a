#include "ngs/problem/problem.h"

namespace ngs {
namespace {

/// A copy with other references, which cannot be reassigned. The only place that copies member by member: a new member
/// does not compile until it is listed here.
Problem rebound(const Problem& from, const GaussianCloud& cloud, const Scene& scene) {
  const auto& [old_cloud, old_scene, views, load_masks, load_photo, splat, background, seed, fixed, labels, rule,
               weight, load_fine_photo, frozen, region, window_share, uncropped, owns, monitor] = from;
  return {cloud, scene,  views,           load_masks, load_photo, splat,        background, seed, fixed,  labels,
          rule,  weight, load_fine_photo, frozen,     region,     window_share, uncropped,  owns, monitor};
}

}  // namespace

Problem Problem::with_model(std::shared_ptr<const GaussianCloud> model, std::vector<LabelColumns> its_labels) const {
  Problem next = rebound(*this, *model, scene);
  next.labels = std::move(its_labels);
  next.weight = nullptr;
  next.owns.push_back(std::move(model));
  return next;
}

Problem Problem::with_views(const Scene& seen, std::function<ViewMasks(std::size_t)> masks,
                            std::function<ImageF(std::size_t)> photo) const {
  Problem next = rebound(*this, cloud, seen);
  next.load_masks = std::move(masks);
  next.load_photo = std::move(photo);
  return next;
}

Problem Problem::cropped(const Scene& seen, std::function<ViewMasks(std::size_t)> masks,
                         std::function<ImageF(std::size_t)> photo, std::vector<double> share) const {
  Problem next = with_views(seen, std::move(masks), std::move(photo));
  next.window_share = std::move(share);
  next.weight = nullptr;
  return next;
}

}  // namespace ngs
