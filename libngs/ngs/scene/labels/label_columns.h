#pragma once
// The columns that a `labelled` PLY adds to the model; one LabelColumns per object.
#include "ngs/scene/labels/label_column.h"

namespace ngs {

struct LabelColumns {
  LabelColumn label;     // [N] final label in [0, 1]; 1 = object
  LabelColumn prob;      // [N] f = Σ αTM / Σ αT (closed form) or the optimised sigmoid
  LabelColumn variance;  // [N] normalised mask variance in [0, 1]                         Eq. (3)
  LabelColumn views;     // [N] number of views with evidence; 0 = never seen
  LabelColumn boundary;  // [N] 1 = member of the boundary set
};

inline constexpr LabelColumn LabelColumns::*kLabelColumns[] = {
    &LabelColumns::label, &LabelColumns::prob, &LabelColumns::variance, &LabelColumns::views, &LabelColumns::boundary};

}  // namespace ngs
