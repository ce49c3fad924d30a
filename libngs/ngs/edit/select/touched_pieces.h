#pragma once
// The connected pieces of a selection that strokes on the object touch. Everything else that a mask selects is debris:
// Gaussians visible through the object, the wall behind it, small fragments.
//
// Pieces are clusters on a grid (clusters.h). A stroke touches every piece with at least a tenth of the stroke's
// rendering weight on the selection, and always the piece with the largest weight. Several strokes on several pieces,
// or one stroke across several pieces, keep all of them. So do masks of several views that show a piece: parts of an
// object may be connected through nothing that is visible.
#include <cstdint>
#include <span>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/scene/gaussian_cloud.h"
#include "ngs/scene/view_prompt.h"
#include "ngs/scene/view_sums.h"

namespace ngs {

// Needles at the cut: long thin Gaussians of an object that stick out of it into what was cut off, such as those that
// hang below a statue without its pedestal. Thin parts of the object that end in empty space are no needles.

/// The rows, ascending, of Gaussians with object[i] != 0 whose longest axis is at least three times the second longest
/// and has an end, at two standard deviations, that is farther than `margin` (world) from every compact solid Gaussian
/// of the object, but not from those of the background. None if `margin` is 0.
std::vector<std::uint32_t> needles_beyond(const Exec& exec, const GaussianCloud& cloud,
                                          const std::vector<std::uint8_t>& object, double margin);

/// The connected strokes on the object in one view as masks, the largest first. With more than kMaxStrokes the
/// smallest share the last mask. Boxes are not strokes.
inline constexpr std::size_t kMaxStrokes = 16;
std::vector<PixelMask> object_strokes(const ViewPrompt& marks);

/// The Gaussians under each of these strokes, with their weight over its pixels; `marks` has the size of the camera.
std::vector<ViewSums> stroke_weights(const Exec& exec, const GaussianCloud& cloud, const Camera& camera,
                                     const ViewPrompt& marks, const SplatOptions& splat);

struct PieceSelection {
  std::vector<std::uint8_t> object;          // [N] 1: in a piece that a stroke touches
  std::int64_t pieces = 0, kept_pieces = 0;  // number of all pieces, and of touched pieces
  std::int64_t removed = 0;                  // Gaussians of the selection in no touched piece
  std::int64_t needles = 0;                  // further ones that stick out of the touched pieces
};

inline constexpr int kMinMasks = 3;
/// Selects among the usable Gaussians with member[i] != 0, without needles. If no stroke touches any of them, all are
/// kept. `masks`: the Gaussians inside the masks of views that were segmented one by one. A piece with at least a
/// hundredth of the weight in each of kMinMasks masks counts as touched.
PieceSelection touched_pieces(const Exec& exec, const GaussianCloud& cloud, const std::vector<std::uint8_t>& member,
                              std::span<const ViewSums> strokes, std::span<const ViewSums> masks = {});

}  // namespace ngs
