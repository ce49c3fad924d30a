#pragma once
// Colours of the hole in a texture: copies of known patches where the texture has detail (Criminisi et al. 2004,
// without their data term: the cell whose surroundings are known best first), guided by its repetition
// (texture_repeats.h); a smooth blend where it has none.
#include "ngs/backend/exec.h"
#include "ngs/edit/fill/texture_grid.h"

namespace ngs {

enum class TextureFill : std::uint8_t { kNothing, kSmooth, kPatches };

/// Sets the colour of all unknown texels, and their state to kKnown. kNothing: no texel is known, or none unknown.
/// Patches are taken whole from known texels; without a whole known patch, the blend is used. `detail` >= 0: the blend
/// is used unless the known texels differ by more than this from the mean of two on opposite sides (RMS, all channels).
/// The same bytes for any number of threads.
TextureFill fill_texture(const Exec& exec, TextureGrid& grid, double detail);

/// The blend alone: every unknown texel is the mean of its four neighbours (Laplace's equation).
void fill_smoothly(TextureGrid& grid);

}  // namespace ngs
