#include "ngs/interactive/kept_strokes.h"

#include <algorithm>

#include "ngs/cut/masks/mask_consensus.h"
#include "ngs/cut/masks/rasterise_prompt.h"
#include "ngs/edit/select/clusters.h"
#include "ngs/interactive/session.h"
#include "ngs/ops/splat/evidence.h"

namespace ngs::live {
namespace {

constexpr double kMinShare = 0.25;  // minimum share of a Gaussian's weight in lost pixels; 0 in the second pass
constexpr double kPainted = 0.1;    // minimum share of a stroke's weight in a part; less is a slip off the object

/// Pixels of `of` that show the model, but with less than half of the weight the object.
PixelMask lost_pixels(const Exec& exec, const Model& model, const std::vector<float>& label, const MarkedView& view,
                      const PixelMask& of) {
  RenderRequest request;
  request.colour = false;
  request.label = {label.data(), model.cloud.size(), 1};
  const RenderedView seen = render(exec, model.cloud, view.camera, model.splat, request);
  PixelMask lost(of.size());
  for (std::size_t p = 0; p < lost.size(); ++p) {
    const float alpha = seen.alpha.data[p];
    lost[p] = of[p] && alpha >= kEmptyAlpha && seen.label.data[p] < 0.5f * alpha;
  }
  return lost;
}

/// The Gaussians with at least the fraction `least` of their weight in these pixels of the view.
std::vector<std::uint32_t> rows_in(const Exec& exec, const Model& model, const MarkedView& view,
                                   const PixelMask& pixels, double least) {
  std::vector<std::uint32_t> rows;
  if (std::ranges::count(pixels, 1) == 0) return rows;
  const ViewSums sums = view_sums(exec, model.cloud, {view.camera, known_view(view.camera, pixels)}, model.splat);
  for (std::size_t v = 0; v < sums.size(); ++v)
    if (sums.object_weight(v, 0) > 0 && sums.object_weight(v, 0) >= least * sums.weight(v)) rows.push_back(sums.row[v]);
  return rows;
}

void restore(std::size_t row, RestoredSelection& found) {
  found.labels.label[row] = 1;
  ++found.labels.count;
  ++found.restored;
}

/// Restores the connected parts of the lost Gaussians that contain at least kPainted of a stroke's weight. `lost` [N]
/// 1: restored under a stroke, or dropped.
void restore_painted_parts(const Exec& exec, const GaussianCloud& cloud, const MarkedViews& views,
                           const std::vector<std::uint8_t>& lost, RestoredSelection& found) {
  const Clusters parts = cluster_on_grid(exec, cloud, lost);
  std::vector<std::uint8_t> painted(parts.size.size());
  for (const auto& view : views)
    for (const ViewSums& stroke : view->touched) {
      std::vector<double> weight(painted.size());
      double whole = 0;
      for (std::size_t v = 0; v < stroke.size(); ++v) {
        whole += stroke.weight(v);
        if (const std::int32_t part = parts.of_row[stroke.row[v]]; part >= 0)
          weight[std::size_t(part)] += stroke.weight(v);
      }
      for (std::size_t p = 0; p < weight.size(); ++p)
        painted[p] |= std::uint8_t(weight[p] > 0 && weight[p] >= kPainted * whole);
    }
  for (std::size_t i = 0; i < lost.size(); ++i)
    if (found.dropped.label[i] > 0 && parts.of_row[i] >= 0 && painted[std::size_t(parts.of_row[i])]) {
      found.dropped.label[i] = 0;
      --found.dropped.count;
      restore(i, found);
    }
}

}  // namespace

RestoredSelection restore_under_strokes(const Exec& exec, const Model& model, const ObjectLabels& refined,
                                        const ObjectMarks& marks) {
  Session session(exec, model);
  Marks only;
  only.objects = {marks};
  only.objects[0].edits = nullptr;
  for (std::shared_ptr<const MarkedView>& view : only.objects[0].views) {
    MarkedView plain = *view;
    plain.seen = nullptr;  // of the Gaussians of the model that was marked
    view = std::make_shared<const MarkedView>(std::move(plain));
  }
  session.restore(std::move(only));
  const ObjectLabels& selected = *session.shown()->front().touched;
  RestoredSelection found{refined, 0, ObjectLabels::none(refined.label.size())};
  const MarkedViews views = session.marks()->objects[0].views;
  for (const double least : {kMinShare, 0.0})
    for (const auto& view : views) {
      const ViewPrompt drawn = rasterise(view->strokes, view->camera.width_px, view->camera.height_px);
      const PixelMask lost =
          lost_pixels(exec, model, found.labels.label, *view, pixels_with(drawn, PixelHint::kObject));
      for (const std::uint32_t row : rows_in(exec, model, *view, lost, least))
        if (selected.label[row] > 0 && found.labels.label[row] == 0) restore(row, found);
    }
  for (const auto& view : views)
    for (const std::uint32_t row :
         rows_in(exec, model, *view, lost_pixels(exec, model, found.labels.label, *view, view->mask), kMinShare))
      if (selected.label[row] > 0 && found.labels.label[row] == 0 && found.dropped.label[row] == 0) {
        found.dropped.label[row] = 1;
        ++found.dropped.count;
      }
  if (found.restored == 0 || found.dropped.count == 0) return found;
  std::vector<std::uint8_t> lost(refined.label.size());
  for (std::size_t i = 0; i < lost.size(); ++i)
    lost[i] = found.dropped.label[i] > 0 || found.labels.label[i] != refined.label[i];
  restore_painted_parts(exec, model.cloud, views, lost, found);
  return found;
}

}  // namespace ngs::live
