#pragma once
// Imports a hand-edited splat as hard label constraints. Editors reorder rows and drop extra columns, so rows are
// matched by exact position, or by the nearest position if the edit's file format rounds positions.
#include <string>

#include "ngs/scene/gaussian_cloud.h"

namespace ngs {

struct ImportedEdit {
  std::vector<float> label;                       // [N] 0 or 1 if fixed, else the input's label
  std::vector<float> fixed;                       // [N] 1: label set by hand, 0: free
  std::int64_t matched = 0;                       // rows of the edit that were found in the model
  std::int64_t unmatched = 0;                     // rows of the edit that were not found
  std::int64_t to_object = 0, to_background = 0;  // labels that changed
  bool by_selection = false;                      // the edit marks the object's rows as selected
  bool by_nearest = false;                        // the edit's positions are rounded: matched by nearest position
  std::string turned = {};                        // "by 180 degrees about x": the edit is the model turned; empty: not
};

/// `object` is the current decision [N], `label` the current labels [N]. `state` has the bits 1 selected, 4 deleted.
///   - If `state` selects rows, they are fixed as object and the other rows of the edit as background.
///   - Otherwise the edit is the object: its rows that are not deleted are fixed as object.
///   - Rows missing from the edit are fixed as background if they were object; otherwise they are free.
/// Gaussians at one position are matched by opacity and colour, then in row order. If fewer than half of the edit's
/// rows are at positions of the model, all are matched greedily by distance, up to a quarter of the model's usual size.
/// If fewer than half are found so, the edit is tried as the model turned by 180 degrees about an axis, or by 90 about
/// x, as some converters write it. Throws kNothingFound for an edit without rows, and kInconsistent if fewer than half
/// of the edit's rows are found. It also throws for an edit that contains every row without a selection: SuperSplat
/// exports no selection, and all rows would become object.
ImportedEdit import_edit(const GaussianCloud& cloud, const std::vector<std::uint8_t>& object,
                         const std::vector<float>& label, const GaussianCloud& edit,
                         const std::vector<std::uint8_t>& state);

}  // namespace ngs
