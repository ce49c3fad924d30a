#pragma once
// Corrections of a selection by hand: Gaussians inside an outline or a ball are added or taken, the selection is
// inverted, or grows or shrinks by its neighbours. Edits are geometric, so that they apply to a refined model too, and
// are repeated in their order whenever the labels under them change.
#include <array>
#include <span>

#include "ngs/interactive/frame.h"
#include "ngs/ops/splat/splat_options.h"

namespace ngs::live {

/// Applies the edits to `labels` and updates their count; `removed` stays. Rows with blocked[i] != 0 (empty: none) are
/// then unselected. Only usable Gaussians are added. kGrow adds Gaussians nearer to a selected one than twice the usual
/// distance between neighbours of the selection; kShrink removes those that are so near to an unselected one. A
/// Gaussian is visible in a view by kMinMeanWeight.
ObjectLabels with_edits(const Exec& exec, const Model& model, ObjectLabels labels,
                        std::span<const std::shared_ptr<const HandEdit>> edits,
                        std::span<const std::uint8_t> blocked = {});

/// The ball under a pixel of a view: on the surface that is seen there, `radius_px` wide in the picture. Throws kUsage
/// if nothing is seen there.
HandEdit ball_at(const Exec& exec, const GaussianCloud& cloud, const SplatOptions& splat, const Viewpoint& viewpoint,
                 std::array<double, 3> x_y_radius_px);

}  // namespace ngs::live
