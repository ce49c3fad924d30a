#pragma once
// Takes a hand-edited splat back as hard constraints. Editors reorder rows and drop extra columns, so the
// rows of both are matched by their exact position; those of a format that rounds positions by the nearest one.
#include "ngs/scene/gaussian_cloud.h"

namespace ngs {

struct ImportedEdit {
  std::vector<float> label;                       // [N] 0 or 1 where fixed, else the input's label
  std::vector<float> fixed;                       // [N] 1: decided by hand, 0: free
  std::int64_t matched = 0;                       // rows of the edit that were found
  std::int64_t unmatched = 0;                     // rows of the edit that were not
  std::int64_t to_object = 0, to_background = 0;  // labels that changed
  bool by_selection = false;                      // the edit says which of its rows are the object
  bool by_nearest = false;                        // its positions are rounded: rows were matched by the nearest ones
};

/// `object` is the current decision [N], `label` the current labels [N]. Without `state`, or where no row of
/// it is selected, the edit is the object: rows in it (and not deleted) are fixed as object. With `state`
/// (bits: 1 selected, 4 deleted) its selected rows are the object and its others the background. Rows that
/// are not in the edit were deleted if they were object: fixed as background; else nobody has looked at them:
/// free. Gaussians at one position are told apart by opacity and colour, else taken in order. Where fewer than half of
/// the edit's rows are at positions of the model, each goes with the nearest row that no nearer one takes, at most a
/// quarter of the model's usual size away. Throws kInconsistent if fewer than half of the edit's rows are found, and
/// for an edit that holds the whole model without a selection: SuperSplat exports none, and all would become object.
ImportedEdit import_edit(const GaussianCloud& cloud, const std::vector<std::uint8_t>& object,
                         const std::vector<float>& label, const GaussianCloud& edit,
                         const std::vector<std::uint8_t>& state);

}  // namespace ngs
