#include "support/stroke_rule.h"

#include <algorithm>
#include <cmath>

#include "ngs/ops/image/metrics.h"
#include "ngs/ops/image/outline.h"
#include "ngs/ops/image/pixel_window.h"

namespace ngs::test {
namespace {

constexpr double kDepth = 0.25;              // of the largest distance to the contour
constexpr double kAway = 0.02;               // distance of the loop, fraction of the diagonal
constexpr std::size_t kMaxCandidates = 300;  // candidate ends of the object stroke
constexpr std::size_t kMinCorners = 12;      // smallest outline for a stroke

struct Raster {
  const PixelMask& set;
  int width_px, height_px;

  bool at(int x, int y) const { return set[std::size_t(y) * std::size_t(width_px) + std::size_t(x)] != 0; }
  bool contains_line(GridPoint a, GridPoint b) const {
    const int steps = std::max(std::abs(b.x - a.x), std::abs(b.y - a.y));
    for (int s = 0; s <= steps; ++s) {
      const double t = steps > 0 ? double(s) / steps : 0;
      if (!at(int(std::lround(a.x + t * (b.x - a.x))), int(std::lround(a.y + t * (b.y - a.y))))) return false;
    }
    return true;
  }
};

/// Evenly sampled boundary pixels.
std::vector<GridPoint> rim_of(const Raster& raster) {
  std::vector<GridPoint> rim, some;
  for (int y = 1; y + 1 < raster.height_px; ++y)
    for (int x = 1; x + 1 < raster.width_px; ++x)
      if (raster.at(x, y) &&
          !(raster.at(x - 1, y) && raster.at(x + 1, y) && raster.at(x, y - 1) && raster.at(x, y + 1)))
        rim.push_back({x, y});
  const std::size_t step = std::max<std::size_t>(1, (rim.size() + kMaxCandidates - 1) / kMaxCandidates);
  for (std::size_t i = 0; i < rim.size(); i += step) some.push_back(rim[i]);
  return some;
}

PromptStroke through_the_middle(const PixelMask& truth, int width_px, int height_px) {
  const auto depth = chessboard_distance({truth.data(), width_px, height_px}, Outside::kComplement);
  const double least = kDepth * *std::max_element(depth.begin(), depth.end());
  PixelMask core(truth.size());
  for (std::size_t p = 0; p < core.size(); ++p) core[p] = double(depth[p]) > least;
  const Raster raster{core, width_px, height_px};
  const std::vector<GridPoint> rim = rim_of(raster);
  PromptStroke stroke;
  stroke.radius_px = std::clamp(least - 1, 0.75, stroke.radius_px);  // stays inside the core
  double longest = -1;
  for (std::size_t i = 0; i < rim.size(); ++i)
    for (std::size_t j = i; j < rim.size(); ++j) {
      const double length = std::hypot(double(rim[j].x - rim[i].x), double(rim[j].y - rim[i].y));
      if (length <= longest || !raster.contains_line(rim[i], rim[j])) continue;
      longest = length;
      stroke.points = {{rim[i].x + 0.5, rim[i].y + 0.5}, {rim[j].x + 0.5, rim[j].y + 0.5}};
    }
  return stroke;
}

/// Adds the parts of the loop inside the picture as background strokes. Parts along the frame are left out, since the
/// object may continue outside.
void add_parts(const Loop& loop, double distance_px, const PixelWindow& picture, std::vector<PromptStroke>& strokes) {
  PromptStroke part;
  part.object = false;
  part.radius_px = std::clamp(distance_px - 1, 0.75, part.radius_px);  // does not touch the object
  const auto end_part = [&] {
    if (part.points.size() > 1) strokes.push_back(part);
    part.points.clear();
  };
  for (std::size_t i = 0; i <= loop.size(); ++i) {
    const GridPoint p = loop[i % loop.size()];
    if (p.x <= 0 || p.y <= 0 || p.x >= picture.w || p.y >= picture.h)
      end_part();
    else
      part.points.push_back({double(p.x), double(p.y)});
  }
  end_part();
}

}  // namespace

HandPrompt strokes_of_truth(const PixelMask& truth, int width_px, int height_px, const std::string& view) {
  HandPrompt prompt{view, width_px, height_px, {}, {}, {}, {}};
  PixelMask outside(truth.size());
  for (std::size_t p = 0; p < truth.size(); ++p) outside[p] = !truth[p];
  if (std::find(truth.begin(), truth.end(), 1) == truth.end()) return prompt;
  PromptStroke middle = through_the_middle(truth, width_px, height_px);
  if (!middle.points.empty()) prompt.strokes.push_back(std::move(middle));
  const auto away = chessboard_distance({outside.data(), width_px, height_px}, Outside::kUnknown);
  const double distance = kAway * std::hypot(double(width_px), double(height_px));
  PixelMask wide(truth.size());
  for (std::size_t p = 0; p < wide.size(); ++p) wide[p] = double(away[p]) <= distance;
  for (const Loop& loop : outlines({wide.data(), width_px, height_px}))
    if (loop.size() >= kMinCorners) add_parts(loop, distance, {0, 0, width_px, height_px}, prompt.strokes);
  return prompt;
}

}  // namespace ngs::test
