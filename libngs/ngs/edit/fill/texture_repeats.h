#pragma once
// Continues a texture by its repetition: the offsets at which known texels are alike are found for the whole texture
// (He and Sun 2012), and an unknown texel is the mean of the known ones at the best of them. Tiles and stripes
// continue; what does not repeat becomes smooth.
#include "ngs/edit/fill/fill_texture.h"

namespace ngs {

/// Sets the colour of the unknown texels that have an alike known one, and their state to kKnown. Returns the mean,
/// over all unknown texels, of the likeness at the best offset: 1 for equal colours, 0 for those of unrelated texels,
/// and 0 where no offset leads to a known texel. The same for any number of threads.
double fill_by_repeats(const Exec& exec, TextureGrid& grid);

}  // namespace ngs
