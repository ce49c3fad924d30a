#pragma once
// Finds what a refined result lost of the marked selection, and restores the part that strokes cover.
#include <memory>

#include "ngs/interactive/frame.h"
#include "ngs/interactive/marks.h"

namespace ngs::live {

struct RestoredSelection {
  ObjectLabels labels;        // of the refined result, with the restored Gaussians
  std::int64_t restored = 0;  // number of restored Gaussians
  ObjectLabels dropped;       // lost Gaussians that are not restored
};

/// `refined`: labels of `model`, a result made from `marks`; its Gaussians may differ from those of the marked model. A
/// Gaussian that the marked views select is restored if it is visible in pixels under object strokes that the refined
/// object does not show. It is dropped if it is visible in such pixels of a mask. A connected part of restored and
/// dropped Gaussians with at least a tenth of a stroke's weight is restored completely, such as a thin neck with the
/// head on it. `dropped` has no boundary.
RestoredSelection restore_under_strokes(const Exec& exec, const Model& model, const ObjectLabels& refined,
                                        const ObjectMarks& marks);

}  // namespace ngs::live
