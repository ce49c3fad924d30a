#pragma once
// Fills the hole in a texture. With detail, known patches are copied (Criminisi et al. 2004; priority is their
// confidence term alone), guided by the texture's repetition (texture_repeats.h). Without detail, the known colours are
// blended smoothly.
#include "ngs/backend/exec.h"
#include "ngs/edit/fill/texture_grid.h"

namespace ngs {

enum class TextureFill : std::uint8_t { kNothing, kSmooth, kPatches };

/// Sets the colour of all unknown texels, and their state to kKnown. kNothing: no texel is known, or none unknown. The
/// blend is used if the detail is at most `detail` >= 0, or if no patch is known completely. Detail is the RMS
/// difference of a known texel from the mean of two texels on opposite sides (all channels). The result does not depend
/// on exec.threads.
TextureFill fill_texture(const Exec& exec, TextureGrid& grid, double detail);

/// The blend alone: every unknown texel is the mean of its four neighbours (Laplace's equation).
void fill_smoothly(TextureGrid& grid);

}  // namespace ngs
