#pragma once
// The marks of a user: objects, and for each the views with strokes. Values share unchanged parts, so that undo
// restores an earlier copy.
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ngs/interactive/viewpoint.h"
#include "ngs/scene/hand_prompt.h"
#include "ngs/scene/view_prompt.h"
#include "ngs/scene/view_sums.h"

namespace ngs::live {

/// A correction by hand (hand_edit.h).
enum class EditAction : std::uint8_t { kAdd, kTake, kInvert, kGrow, kShrink };

struct HandEdit {
  EditAction action = EditAction::kAdd;
  // The shape of kAdd and kTake: Gaussians with their centre in it.
  Viewpoint viewpoint;                         // of `outline`
  std::vector<std::array<double, 2>> outline;  // px, at least three: everything inside; empty: the ball
  bool visible_only = false;                   // of the outline: without Gaussians that are hidden in this view
  Vec3<double> centre{0, 0, 0};                // world
  double radius = 0;                           // world
};
using HandEdits = std::vector<std::shared_ptr<const HandEdit>>;

struct MarkedView {
  std::string name;                      // of its image, "0001.png"; unique within an object
  Viewpoint viewpoint;                   // the view that was marked
  Camera camera;                         // at the segmented size, named after the image
  HandPrompt strokes;                    // in pixels of `viewpoint`
  PixelMask mask;                        // at the size of `camera`
  std::shared_ptr<const ViewSums> seen;  // weights of the visible Gaussians; they do not depend on the marks
  ViewSums inside;                       // weights inside the mask
  std::vector<ViewSums> touched;         // weights under each stroke on the object
};

struct ObjectMarks {
  int id = 0;
  std::string name, colour;                              // "#rrggbb"
  int next_view = 1;                                     // number of the next image
  std::vector<std::shared_ptr<const MarkedView>> views;  // in the order of their first strokes
  std::shared_ptr<const HandEdits> edits = {};           // applied in order to the labels of the strokes; null: none
  bool keeps_dropped = false;  // a refined result keeps what the strokes select and it drops (hand_edit.h)
  bool hidden = false;         // not drawn, not selectable by other objects' edits, and no strokes meanwhile
  bool locked = false;         // unchangeable, and its Gaussians belong to no other object

  bool is_empty() const { return views.empty() && !edits; }

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
  bool all_pieces = false;  // also show and write pieces that no stroke touches

  const ObjectMarks* find(int id) const {
    for (const ObjectMarks& object : objects)
      if (object.id == id) return &object;
    return nullptr;
  }
  ObjectMarks* find(int id) { return const_cast<ObjectMarks*>(std::as_const(*this).find(id)); }
};

}  // namespace ngs::live
