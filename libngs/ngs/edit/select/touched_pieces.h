#pragma once
// The connected pieces of a selection that strokes on the object touch. Everything else that a mask selects is debris:
// Gaussians visible through the object, the wall behind it, small fragments.
//
// Pieces are clusters on a grid (clusters.h). A stroke touches every piece with at least a tenth of the stroke's
// rendering weight on the selection, and always the piece with the largest weight. All touched pieces are kept. A piece
// that masks of several views show is kept too, because parts of an object may have no visible connection.
#include <cstdint>
#include <span>
#include <vector>

#include "ngs/ops/splat/splat.h"
#include "ngs/scene/view_prompt.h"
#include "ngs/scene/view_sums.h"

namespace ngs {

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
  std::int64_t needles = 0;                  // further ones that stick out of the touched pieces (needles.h)
};

inline constexpr int kMinMasks = 3;
/// Selects among the usable Gaussians with member[i] != 0, without needles. If no stroke touches any of them, all are
/// kept. `masks`: the Gaussians inside the masks of views that were segmented one by one. A piece with at least a
/// hundredth of the weight in each of kMinMasks masks counts as touched.
PieceSelection touched_pieces(const Exec& exec, const GaussianCloud& cloud, const std::vector<std::uint8_t>& member,
                              std::span<const ViewSums> strokes, std::span<const ViewSums> masks = {});

}  // namespace ngs
