#include "memory_plan.h"

#include <algorithm>

#include "ngs/capture/view_shares.h"
#include "ngs/io/image/photo.h"
#include "ngs/problem/coarse_input.h"
#include "ngs/problem/region.h"
#include "ngs/problem/view_list.h"
#include "shared/scene/scene_model.h"

namespace ngs::joint {
namespace {

/// Photos cached at the working size and at the size of decisions, and renders at the latter.
double photo_cache_bytes(const Scene& scene) {
  constexpr double kMaxCacheBytes = 256 * cli::kMib;  // bytes per cache
  double px = 0, packed = 0;
  for (const std::size_t v : photo_views(scene)) {
    px += cli::view_px(scene.views[v]);
    packed += io::packed_photo_bytes(scene, v);
  }
  const double fewer = decision_shrink(scene) * decision_shrink(scene);
  return std::min(kMaxCacheBytes, packed) + std::min(kMaxCacheBytes, 12 * px / fewer) +
         std::min(kMaxCacheBytes, 16 * px / fewer);
}

/// Photos and masks of the training views during the steps, as if none could be packed, and the images of one step.
double step_picture_bytes(const Problem& problem) {
  constexpr double kMaxCacheBytes = 512 * cli::kMib;
  constexpr double kBytesPerPx = 900;  // of the losses, and of contour refinement at twice the size
  double px = 0;
  for (const std::size_t v : problem.views) px += cli::view_px(problem.scene.views[v]);
  return std::min(kMaxCacheBytes, (12 + 4.0 * double(problem.labels.size())) * px) +
         kBytesPerPx * cli::largest_view_px(problem.scene);
}

/// Trained parameters: values, gradients and two Adam moments of the rows in the region.
double trained_bytes(const Problem& problem) {
  const std::vector<std::uint8_t> region = region_of(problem.labels);
  const auto rows = double(std::ranges::count(region, std::uint8_t(1)));
  return rows * 4 * 4 * (14 + 3.0 * problem.cloud.rest_count() + double(problem.labels.size()));
}

/// Largest fraction of Gaussians inside a view, over at most kViews training views.
double visible_share(const Problem& problem) {
  constexpr std::size_t kViews = 8;
  const std::vector<std::int64_t> sample = sample_usable(problem.cloud);
  double most = 0;
  for (const std::size_t v : spread_views(problem.views, sample.empty() ? 0 : kViews))
    most = std::max(most, view_shares(problem.cloud, problem.scene.views[v].camera, sample).inside);
  return most;
}

/// Bytes per visible Gaussian of a forward and backward pass with so many channels.
double pass_bytes(double channels) { return 2 * cli::kVisibleBytes + cli::kTilesReached * (20 + 4 * channels); }

}  // namespace

Json memory_plan(const Problem& problem) {
  const auto n = double(problem.cloud.size()), objects = double(problem.labels.size());
  const double owners = std::min(objects, 2.0), shown = visible_share(problem);
  const double model = cli::model_bytes(problem.cloud), drawn = model + cli::kPreparedBytes;
  const double read = drawn + 4 + cli::label_bytes(owners);
  const double evidence =
      32 + 64 * owners + 4 * (objects + 1) + 12;         // of all views; of other objects' labels; of one view
  const double search = drawn + 16 + 8 + 1 + 3 * 8 + 2;  // search for floaters, and the model without them
  const double labels_alone = read + evidence + search + shown * pass_bytes(objects + 3);
  const double steps =
      labels_alone + drawn + 4 * objects + shown * 4 * 12 * cli::kTilesReached;  // values and gradients
  const double pictures = photo_cache_bytes(problem.scene);
  return {{"visible_share", shown},
          {"bytes_per_gaussian", labels_alone},
          {"bytes_per_gaussian_with_steps", steps},
          {"estimated_peak_mib", cli::peak_mib(labels_alone * n + pictures)},
          {"estimated_peak_mib_with_steps",
           cli::peak_mib(steps * n + trained_bytes(problem) + pictures + step_picture_bytes(problem))}};
}

}  // namespace ngs::joint
