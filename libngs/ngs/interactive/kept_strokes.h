#pragma once
// What a refined result loses of the selection that it was made from, and the part of it that strokes cover.
#include <memory>

#include "ngs/interactive/frame.h"
#include "ngs/interactive/marks.h"

namespace ngs::live {

struct KeptStrokes {
  ObjectLabels labels;        // of the refined result, with what strokes on the object cover
  std::int64_t restored = 0;  // number of these
  ObjectLabels dropped;       // what else the marked views select and would show in their masks
};

/// `refined`: labels of `model`, a result made from `marks`, perhaps with other Gaussians than the model that was
/// marked. A Gaussian is restored if the marked views select it and it is visible in pixels under object strokes
/// that the refined object does not show; it is dropped if it is visible in such pixels of a mask. A connected part of
/// both with at least a tenth of a stroke's weight is restored as a whole: a thin neck, and the head that it carries.
/// `dropped` has no boundary.
KeptStrokes keep_under_strokes(const Exec& exec, const Model& model, const ObjectLabels& refined,
                               const ObjectMarks& marks);

}  // namespace ngs::live
