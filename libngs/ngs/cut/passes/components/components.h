#pragma once
// Disconnected components: labelled Gaussians that are not connected to the object.              paper.md §5.13
//
// A Gaussian behind the object is nearly hidden in the views across the object. Its faint contribution lies within the
// mask, so its closed-form label is 1, and a view that sees it unoccluded shows background as object. So little
// evidence does not allow a test, but an object is connected. Labelled Gaussians in neighbouring cells of a grid are
// linked; the side of a cell is the core's margin (object_core.h). A Gaussian with object evidence is disconnected if
// none of the neighbouring cells is linked to the core.
#include "ngs/problem/object_core.h"

namespace ngs {

struct ComponentFinding {
  std::vector<LabelColumns> labels;        // those of the input; all columns of disconnected Gaussians are 0
  std::vector<std::uint8_t> disconnected;  // [N] 1: disconnected from some object, and left with no object
  std::int64_t count = 0;                  // disconnected (Gaussian, object) pairs
};

/// Finds nothing without a core, or with masks of so few views that one view is half of them. Rows fixed by hand keep
/// their labels. `labels`: those of the input; returned with the changes.
ComponentFinding find_disconnected(const Exec& exec, const Problem& input, std::vector<LabelColumns> labels);
/// The count alone, without a copy of the labels.
std::int64_t count_disconnected(const Exec& exec, const Problem& input);

/// Restores the input's label of Gaussians that training labelled as object although they are not connected to it.
/// Training can follow the faint contribution of a Gaussian behind the object. Returns the number of restored labels.
std::int64_t restore_disconnected_labels(const Exec& exec, const Problem& input, Solution& solution);

}  // namespace ngs
