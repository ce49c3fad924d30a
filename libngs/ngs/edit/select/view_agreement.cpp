#include "ngs/edit/select/view_agreement.h"

#include "ngs/core/check.h"
#include "ngs/cut/masks/mask_consensus.h"
#include "ngs/ops/image/connected_components.h"
#include "ngs/ops/image/mask_pair.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs {
namespace {

constexpr double kStrokeMargin = 0.01;     // tolerated increase of wrong stroke pixels, as a fraction of all
constexpr double kAgreementMargin = 0.02;  // tolerated decrease of the mean IoU

struct Counted {
  std::int64_t pixels = 0, wrong = 0;
  int x = 0, y = 0;  // first wrong pixel
};

}  // namespace

double view_agreement(const Exec& exec, const LabelledSplat& model, std::span<const Camera> cameras,
                      std::span<const PixelMask> masks) {
  NGS_CHECK(cameras.size() == masks.size(), "one mask per camera");
  RenderRequest request{.colour = false, .label = {model.label.data(), model.cloud.size(), 1}};
  double sum = 0;
  std::int64_t views = 0;
  for (std::size_t v = 0; v < masks.size(); ++v) {
    if (masks[v].empty()) continue;
    const RenderedView view = render(exec, model.cloud, cameras[v], model.splat, request);
    NGS_CHECK(view.label.data.size() == masks[v].size(), "masks of the cameras' size");
    MaskOverlap overlap;
    for (std::size_t p = 0; p < masks[v].size(); ++p)
      overlap.add(label_is_foreground(view.label.data[p]), masks[v][p] != 0);
    if (overlap.either > 0) {
      sum += overlap.iou();
      ++views;
    }
  }
  return views > 0 ? sum / double(views) : 1;
}

bool is_worse(const ResultQuality& result, const ResultQuality& other) {
  return result.strokes_wrong > other.strokes_wrong + kStrokeMargin ||
         result.agreement < other.agreement - kAgreementMargin;
}

std::vector<float> fix_boundary(const LabelColumns& first, LabelColumns& trained) {
  const std::size_t n = trained.label.size();
  NGS_CHECK(first.label.size() == n && trained.boundary.size() == n, "labels of the same Gaussians");
  std::vector<float> fixed(n);
  for (std::size_t i = 0; i < n; ++i)
    if (is_set(trained.boundary[i])) {
      trained.label[i] = first.label[i];
      fixed[i] = 1;
    }
  return fixed;
}

void add_stroke_agreement(const Exec& exec, const LabelledSplat& model, const Camera& camera, const ViewPrompt& marks,
                          StrokeAgreement& agreement) {
  const int w = marks.width_px, h = marks.height_px;
  NGS_CHECK(w == camera.width_px && h == camera.height_px, "marks of the camera's size");
  RenderRequest request{.colour = false, .label = {model.label.data(), model.cloud.size(), 1}};
  const RenderedView view = render(exec, model.cloud, camera, model.splat, request);
  for (const PixelHint side : {PixelHint::kObject, PixelHint::kBackground}) {
    const PixelMask marked = pixels_with(marks, side);
    const ConnectedComponents strokes = connected_components({marked.data(), w, h});
    std::vector<Counted> counted(strokes.size.size());
    for (std::size_t p = 0; p < marked.size(); ++p) {
      if (!marked[p] || (side == PixelHint::kBackground && view.alpha.data[p] < kEmptyAlpha)) continue;
      Counted& stroke = counted[std::size_t(strokes.component[p])];
      ++stroke.pixels;
      if (label_is_foreground(view.label.data[p]) == (side == PixelHint::kObject)) continue;
      if (stroke.wrong++ == 0) {
        stroke.x = int(p % std::size_t(w));
        stroke.y = int(p / std::size_t(w));
      }
    }
    for (const Counted& stroke : counted) {
      agreement.pixels += stroke.pixels;
      agreement.wrong += stroke.wrong;
      if (double(stroke.wrong) > kBrokenShare * double(stroke.pixels))
        agreement.broken.push_back({camera.name, side == PixelHint::kObject, stroke.x, stroke.y,
                                    double(stroke.wrong) / double(stroke.pixels)});
    }
  }
}

}  // namespace ngs
