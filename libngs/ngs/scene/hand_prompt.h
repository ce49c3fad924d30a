#pragma once
// A user's annotations of one view: strokes, polygons and boxes, in pixels of an image of the given size.
#include <array>
#include <string>
#include <vector>

#include "ngs/scene/view_prompt.h"

namespace ngs {

struct PromptStroke {
  bool object = true;  // else background
  double radius_px = 3;
  std::vector<std::array<double, 2>> points;  // at least one
};

struct PromptPolygon {
  bool object = true;                         // else background
  std::vector<std::array<double, 2>> points;  // at least three; closed implicitly; even-odd rule
};

struct HandPrompt {
  std::string view;  // empty: not given
  int width_px = 0, height_px = 0;
  std::vector<PromptStroke> strokes;
  std::vector<PromptPolygon> polygons;
  std::vector<std::array<double, 4>> boxes;  // left, top, right, bottom; the object lies inside their union
  std::vector<PixelHint>
      painted;  // [H·W] from a scribble image; unpainted pixels: certain or likely background; may be empty
};

}  // namespace ngs
