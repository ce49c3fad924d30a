#pragma once
// Corrections of a selection by hand: Gaussians inside an outline or a ball are added or taken, the selection is
// inverted, or grows or shrinks by its neighbours. Edits are geometric, so that they apply to a refined model too, and
// are repeated in their order whenever the labels under them change.
#include <array>
#include <span>

#include "ngs/interactive/frame.h"
#include "ngs/ops/image/grab_cut.h"
#include "ngs/ops/splat/splat_options.h"
#include "ngs/scene/view_prompt.h"

namespace ngs::live {

// Local correction of a mask by strokes: pixels under strokes are fixed, pixels near them are segmented again, all
// others stay.

/// Input of the segmentation when strokes are added to a visible selection.
struct Correction {
  const PixelMask& before;            // the selection
  const ViewPrompt &strokes, &added;  // all strokes of the view, and the new ones among them

  /// Hints: certain under strokes. Pixels farther than `reach_px` from the new strokes and than `band_px` from the
  /// selection's contour keep their side; `band_px` 0: no band. Without a stroke on the object, the half of the
  /// selection that is farther from the new strokes keeps its side: it shows the object's colours and place.
  ViewPrompt prompt(int reach_px, int band_px) const;
  /// Colour samples of each side: half from its strokes and half from all its pixels, because strokes do not cover
  /// every colour of an image. At most `max_samples` per half.
  SideColours colours(const ImageU8& picture, int max_samples) const;
};

/// Applies to `before` only the changes in `found` that are connected to the new strokes, and towards their side.
PixelMask corrected(const PixelMask& before, const PixelMask& found, const ViewPrompt& strokes);

/// The labels after the edits, without rows with blocked[i] != 0 (empty: none). An added Gaussian is usable. kGrow adds
/// Gaussians nearer to a selected one than twice the usual distance between neighbours of the selection; kShrink takes
/// those that are so near to one that is not selected. A Gaussian is visible in a view by kMinMeanWeight. The count
/// fits the labels; `removed` stays.
ObjectLabels with_edits(const Exec& exec, const Model& model, ObjectLabels labels,
                        std::span<const std::shared_ptr<const HandEdit>> edits,
                        std::span<const std::uint8_t> blocked = {});

/// The ball under a pixel of a view: on the surface that is seen there, `radius_px` wide in the picture. Throws kUsage
/// if nothing is seen there.
HandEdit ball_at(const Exec& exec, const GaussianCloud& cloud, const SplatOptions& splat, const Viewpoint& viewpoint,
                 std::array<double, 3> x_y_radius_px);

}  // namespace ngs::live
