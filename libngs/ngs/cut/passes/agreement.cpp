#include "ngs/cut/passes/agreement.h"

#include <algorithm>

#include "ngs/ops/image/mask_pair.h"
#include "ngs/problem/view_list.h"
#include "ngs/render/render_stage.h"

namespace ngs {

std::vector<Agreement> training_agreement(const Exec& exec, const Problem& problem, const Solution& solution,
                                          std::size_t most_views) {
  const std::size_t objects = solution.labels.size();
  const LabelChannels channels(exec, *solution.cloud, solution.labels);
  const SplatOptions splat = prepared_for(exec, problem.splat, *solution.cloud);
  std::vector<Agreement> views;
  const std::vector<std::size_t> some = most_views > 0 ? spread_views(problem.views, most_views) : problem.views;
  for_each_view(problem.monitor, some, [&](std::size_t, std::size_t view) {
    const ViewMasks masks = problem.load_masks(view);
    if (!masks.available) return;
    const ImageF label = channels.masks(exec, problem.scene.views[view].camera, splat);
    const std::vector<ForegroundBox> boxes = foreground_boxes(label);
    Agreement sum;
    for (std::size_t k = 0; k < objects; ++k) {
      const MaskPair pair(label, masks, k, boxes[k]);
      sum.iou += iou(pair.counts(exec));
      sum.biou += pair.biou(exec);
    }
    views.push_back({sum.iou / double(objects), sum.biou / double(objects)});
  });
  return views;
}

Agreement mean_agreement(const std::vector<Agreement>& views) {
  Agreement sum;
  for (const Agreement& view : views) {
    sum.iou += view.iou;
    sum.biou += view.biou;
  }
  const double count = std::max<double>(1, double(views.size()));
  return {sum.iou / count, sum.biou / count};
}

}  // namespace ngs
