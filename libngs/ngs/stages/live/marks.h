#pragma once
// What a person has marked: objects, and on each the views that they drew on. Values that share what does not change,
// so that a step back is a copy of before.
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ngs/scene/hand_prompt.h"
#include "ngs/scene/view_prompt.h"
#include "ngs/stages/live/look.h"
#include "ngs/stages/select/touched_pieces.h"

namespace ngs::live {

/// Whom a view sees, and with what weight: the same whatever is marked on it.
struct ViewWeights {
  std::vector<std::uint32_t> row;  // [V] increasing
  std::vector<double> weight;      // [V] > 0, rendering weight over all pixels
};

/// The Gaussians with a part of their weight inside a mask.
struct MaskWeights {
  std::vector<std::uint32_t> row;  // increasing
  std::vector<double> weight;      // > 0, at most that of the view
};

struct MarkedView {
  std::string name;    // of its picture, "0001.png"; of one object's views no two are the same
  Look look;           // as it was drawn on
  Camera camera;       // at the size that is segmented, named after the picture
  HandPrompt strokes;  // in pixels of `look`
  PixelMask mask;      // at the size of `camera`
  std::shared_ptr<const ViewWeights> seen;
  MaskWeights inside;
  std::vector<StrokeWeights> touched;  // of the strokes on the object
};

struct ObjectMarks {
  int id = 0;
  std::string name, colour;                              // "#rrggbb"
  int next_view = 1;                                     // number of the next picture
  std::vector<std::shared_ptr<const MarkedView>> views;  // in the order in which they were first drawn on

  std::size_t strokes() const {
    std::size_t count = 0;
    for (const auto& view : views) count += view->strokes.strokes.size();
    return count;
  }
};

struct Marks {
  std::vector<ObjectMarks> objects;
  int active = 0;  // id of an object
  int next_id = 1;
  bool all_pieces = false;  // show and write what no stroke touches, too

  const ObjectMarks* find(int id) const {
    for (const ObjectMarks& object : objects)
      if (object.id == id) return &object;
    return nullptr;
  }
  ObjectMarks* find(int id) { return const_cast<ObjectMarks*>(std::as_const(*this).find(id)); }
};

}  // namespace ngs::live
