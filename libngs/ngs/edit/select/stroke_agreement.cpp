#include "ngs/edit/select/stroke_agreement.h"

#include "ngs/core/check.h"
#include "ngs/cut/masks/mask_consensus.h"
#include "ngs/ops/image/connected_components.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs {
namespace {

struct Counted {
  std::int64_t pixels = 0, wrong = 0;
  int x = 0, y = 0;  // first wrong pixel
};

}  // namespace

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
      if (stroke.wrong++ == 0) stroke.x = int(p % std::size_t(w)), stroke.y = int(p / std::size_t(w));
    }
    for (const Counted& stroke : counted) {
      agreement.pixels += stroke.pixels, agreement.wrong += stroke.wrong;
      if (double(stroke.wrong) > kBrokenShare * double(stroke.pixels))
        agreement.broken.push_back({camera.name, side == PixelHint::kObject, stroke.x, stroke.y,
                                    double(stroke.wrong) / double(stroke.pixels)});
    }
  }
}

}  // namespace ngs
