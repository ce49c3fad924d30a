#pragma once
// Disconnected components: Gaussians far from the object that its masks claim all the same.     PAPER.md §5.13
//
// What stands behind the object is hidden in the views that look at it across the object; a trace of it shows through,
// all of it within the mask, and so its closed form is 1. Where another view sees it in the open, a piece of the room
// is drawn as object. Evidence that small cannot be weighed against itself; but an object hangs together. Gaussians
// labelled as the object are linked where they lie in neighbouring cells whose side is the core's margin
// (object_core.h); what is claimed and lies beside no cell that is linked with the core is disconnected.
#include "ngs/problem/object_core.h"

namespace ngs {

struct ComponentOptions {
  CoreOptions core{.seen = 0.5, .margin = 0.5};
  double labelled = 0.5;                   // share from which a Gaussian links others to the core
  double claimed = kLeastForegroundShare;  // share from which it may be disconnected
};

struct ComponentFinding {
  std::vector<LabelColumns> labels;        // of the input; what is disconnected is as what no view has seen: all 0
  std::vector<std::uint8_t> disconnected;  // [N] 1: of some object, and no object has a share in it any more
  std::int64_t count = 0;                  // over all objects
};

/// Without a core, as with masks of so few views that every trace is one, nothing is found. Rows fixed by hand stay.
/// `labels`: the input's, which become those of the finding.
ComponentFinding find_disconnected(const Exec& exec, const ComponentOptions& options, const Problem& input,
                                   std::vector<LabelColumns> labels);
/// Its count alone: no labels are copied.
std::int64_t count_disconnected(const Exec& exec, const ComponentOptions& options, const Problem& input);

/// What a method came to label as object although the evidence does not, and what does not hang together with the
/// object, has the input's label again: a trained label may follow a trace that shows through. Returns how many, over
/// all objects.
std::int64_t withdraw_apart(const Exec& exec, const ComponentOptions& options, const Problem& input,
                            Solution& solution);

}  // namespace ngs
