#include "ngs/stages/masks/hand_prompt.h"

#include <algorithm>
#include <cmath>

#include "ngs/core/error.h"
#include "ngs/ops/image/metrics.h"

namespace ngs {
namespace {

using Point = std::array<double, 2>;

double distance_to_segment(double x, double y, Point a, Point b) {
  const double ux = b[0] - a[0], uy = b[1] - a[1], length2 = ux * ux + uy * uy;
  const double t = length2 > 0 ? std::clamp(((x - a[0]) * ux + (y - a[1]) * uy) / length2, 0.0, 1.0) : 0;
  return std::hypot(x - a[0] - t * ux, y - a[1] - t * uy);
}

struct Painter {
  ViewPrompt& prompt;

  /// Pixels whose centre lies in [left, right) x [top, bottom) and satisfies `inside`.
  void fill(Point low, Point high, PixelHint hint, const auto& inside) {
    const auto first = [](double edge) { return int(std::clamp(std::ceil(edge - 0.5), 0.0, 1e6)); };
    for (int y = first(low[1]); y < std::min(prompt.height_px, first(high[1])); ++y)
      for (int x = first(low[0]); x < std::min(prompt.width_px, first(high[0])); ++x)
        if (inside(x + 0.5, y + 0.5))
          prompt.hint[std::size_t(y) * std::size_t(prompt.width_px) + std::size_t(x)] = hint;
  }

  void segment(Point a, Point b, double radius, PixelHint hint) {
    fill({std::min(a[0], b[0]) - radius, std::min(a[1], b[1]) - radius},
         {std::max(a[0], b[0]) + radius + 1, std::max(a[1], b[1]) + radius + 1}, hint,
         [&](double x, double y) { return distance_to_segment(x, y, a, b) <= radius; });
  }
};

}  // namespace

ViewPrompt rasterise(const HandPrompt& hand, int width_px, int height_px) {
  const double sx = double(width_px) / hand.width_px, sy = double(height_px) / hand.height_px;
  if (std::abs(sx / sy - 1) > 0.01)
    throw Error(ErrorCode::kInconsistent,
                "prompts: made on " + std::to_string(hand.width_px) + "x" + std::to_string(hand.height_px) +
                    " px, the view has " + std::to_string(width_px) + "x" + std::to_string(height_px) +
                    " px, expected the same shape",
                "mark the photo of the view that is named, uncropped");
  ViewPrompt out{width_px, height_px, {}, true};
  out.hint.assign(std::size_t(width_px) * std::size_t(height_px),
                  hand.boxes.empty() ? PixelHint::kLikelyBackground : PixelHint::kBackground);
  Painter painter{out};
  for (const auto& box : hand.boxes)
    painter.fill({box[0] * sx, box[1] * sy}, {box[2] * sx, box[3] * sy}, PixelHint::kLikelyObject,
                 [](double, double) { return true; });
  if (!hand.painted.empty()) {
    const std::vector<PixelHint> scaled =
        resized_nearest(hand.painted.data(), hand.width_px, hand.height_px, width_px, height_px);
    for (std::size_t p = 0; p < scaled.size(); ++p)
      if (is_certain(scaled[p])) out.hint[p] = scaled[p];
  }
  for (const PromptStroke& stroke : hand.strokes) {
    const PixelHint hint = stroke.object ? PixelHint::kObject : PixelHint::kBackground;
    for (std::size_t i = 0; i < stroke.points.size(); ++i) {
      const Point a = stroke.points[i > 0 ? i - 1 : 0], b = stroke.points[i];
      painter.segment({a[0] * sx, a[1] * sy}, {b[0] * sx, b[1] * sy}, std::max(0.75, stroke.radius_px * sx), hint);
    }
  }
  return out;
}

}  // namespace ngs
