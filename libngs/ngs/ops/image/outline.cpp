#include "ngs/ops/image/outline.h"

#include <array>

namespace ngs {
namespace {

enum Heading { kRight, kDown, kLeft, kUp };
constexpr std::array<int, 4> kStepX = {1, 0, -1, 0}, kStepY = {0, 1, 0, -1};

struct ContourTracer {
  MaskPlane mask;
  std::vector<std::uint8_t>& seen;  // [H·W] 1: the top edge of this pixel was traced

  bool object(int x, int y) const {
    return x >= 0 && y >= 0 && x < mask.width_px && y < mask.height_px &&
           mask.data[std::int64_t(y) * mask.width_px + x] != 0;
  }

  /// The pixels to the left and right of the edge that leaves corner (x, y) in this direction.
  bool left_of(int x, int y, Heading h) const {
    return object(x - (h == kLeft || h == kUp), y - (h == kRight || h == kUp));
  }
  bool right_of(int x, int y, Heading h) const {
    return object(x - (h == kDown || h == kLeft), y - (h == kLeft || h == kUp));
  }

  Loop trace(int start_x, int start_y) {
    Loop loop;
    int x = start_x, y = start_y;
    Heading heading = kRight;
    do {
      if (heading == kRight) seen[std::size_t(y) * std::size_t(mask.width_px) + std::size_t(x)] = 1;
      x += kStepX[heading];
      y += kStepY[heading];
      const Heading before = heading;
      if (left_of(x, y, before))
        heading = Heading((before + 3) % 4);
      else if (!right_of(x, y, before))
        heading = Heading((before + 1) % 4);
      if (heading != before) loop.push_back({x, y});
    } while (x != start_x || y != start_y || heading != kRight);
    return loop;
  }
};

}  // namespace

std::vector<Loop> outlines(MaskPlane mask) {
  std::vector<std::uint8_t> seen(std::size_t(mask.pixels()), 0);
  ContourTracer tracer{mask, seen};
  std::vector<Loop> loops;
  for (int y = 0; y < mask.height_px; ++y)
    for (int x = 0; x < mask.width_px; ++x)
      if (tracer.object(x, y) && !tracer.object(x, y - 1) &&
          !seen[std::size_t(y) * std::size_t(mask.width_px) + std::size_t(x)])
        loops.push_back(tracer.trace(x, y));
  return loops;
}

}  // namespace ngs
