#include "ngs/cut/masks/rasterise_prompt.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "ngs/core/error.h"
#include "ngs/math/elementary.h"
#include "ngs/ops/image/metrics.h"

namespace ngs {
namespace {

using Point = std::array<double, 2>;

double distance_to_segment(double x, double y, Point a, Point b) {
  const double ux = b[0] - a[0], uy = b[1] - a[1], length2 = ux * ux + uy * uy;
  const double t = length2 > 0 ? std::clamp(((x - a[0]) * ux + (y - a[1]) * uy) / length2, 0.0, 1.0) : 0;
  return portable_hypot(x - a[0] - t * ux, y - a[1] - t * uy);
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

  /// Pixels whose centre is inside by the even-odd rule.
  void polygon(const std::vector<Point>& corners, PixelHint hint) {
    std::vector<double> crossings;
    for (int y = 0; y < prompt.height_px; ++y) {
      crossings.clear();
      for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
        const Point a = corners[j], b = corners[i];
        if ((a[1] <= y + 0.5) != (b[1] <= y + 0.5))
          crossings.push_back(a[0] + (y + 0.5 - a[1]) * (b[0] - a[0]) / (b[1] - a[1]));
      }
      std::sort(crossings.begin(), crossings.end());
      for (std::size_t i = 0; i + 1 < crossings.size(); i += 2)
        fill({crossings[i], double(y)}, {crossings[i + 1], double(y + 1)}, hint, [](double, double) { return true; });
    }
  }
};

void paint_boxes_and_pictures(const HandPrompt& hand, Painter& painter) {
  ViewPrompt& out = painter.prompt;
  const double sx = double(out.width_px) / hand.width_px, sy = double(out.height_px) / hand.height_px;
  for (const auto& box : hand.boxes)
    painter.fill({box[0] * sx, box[1] * sy}, {box[2] * sx, box[3] * sy}, PixelHint::kLikelyObject,
                 [](double, double) { return true; });
  if (hand.painted.empty()) return;
  const std::vector<PixelHint> scaled =
      resized_nearest(hand.painted.data(), hand.width_px, hand.height_px, out.width_px, out.height_px);
  for (std::size_t p = 0; p < scaled.size(); ++p)
    if (is_certain(scaled[p])) out.hint[p] = scaled[p];
}

void paint_polygons_and_strokes(const HandPrompt& hand, Painter& painter) {
  const double sx = double(painter.prompt.width_px) / hand.width_px,
               sy = double(painter.prompt.height_px) / hand.height_px;
  const auto hint_of = [](bool object) { return object ? PixelHint::kObject : PixelHint::kBackground; };
  for (const PromptPolygon& polygon : hand.polygons) {
    std::vector<Point> corners;
    for (const Point& p : polygon.points) corners.push_back({p[0] * sx, p[1] * sy});
    painter.polygon(corners, hint_of(polygon.object));
  }
  for (const PromptStroke& stroke : hand.strokes)
    for (std::size_t i = 0; i < stroke.points.size(); ++i) {
      const Point a = stroke.points[i > 0 ? i - 1 : 0], b = stroke.points[i];
      painter.segment({a[0] * sx, a[1] * sy}, {b[0] * sx, b[1] * sy}, std::max(0.75, stroke.radius_px * sx),
                      hint_of(stroke.object));
    }
}

void require_shape(const HandPrompt& hand, int width_px, int height_px) {
  const double sx = double(width_px) / hand.width_px, sy = double(height_px) / hand.height_px;
  if (std::abs(sx / sy - 1) <= 0.01) return;
  throw Error(ErrorCode::kInconsistent,
              "prompts: made on " + std::to_string(hand.width_px) + "x" + std::to_string(hand.height_px) +
                  " px, the view has " + std::to_string(width_px) + "x" + std::to_string(height_px) +
                  " px, expected the same shape",
              "mark the uncropped photo of the named view");
}

}  // namespace

ViewPrompt rasterise(std::span<const HandPrompt> marks, int width_px, int height_px) {
  bool has_boxes = false;
  for (const HandPrompt& hand : marks) {
    require_shape(hand, width_px, height_px);
    has_boxes |= !hand.boxes.empty();
  }
  ViewPrompt out{width_px, height_px, {}, true};
  out.hint.assign(std::size_t(width_px) * std::size_t(height_px),
                  has_boxes ? PixelHint::kBackground : PixelHint::kLikelyBackground);
  Painter painter{out};
  for (const HandPrompt& hand : marks) paint_boxes_and_pictures(hand, painter);
  for (const HandPrompt& hand : marks) paint_polygons_and_strokes(hand, painter);
  return out;
}

ViewPrompt rasterise(const HandPrompt& hand, int width_px, int height_px) {
  return rasterise({&hand, 1}, width_px, height_px);
}

}  // namespace ngs
