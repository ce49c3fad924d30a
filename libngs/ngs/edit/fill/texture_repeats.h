#pragma once
// Predicts a texture by its repetition: the offsets at which known texels are alike are found for the whole texture (He
// and Sun 2012), and an unknown texel is the mean of the known ones at the best of them. Tiles and stripes continue;
// what does not repeat becomes smooth.
#include "ngs/backend/exec.h"
#include "ngs/edit/fill/texture_grid.h"

namespace ngs {

struct Repeats {
  std::vector<float> colour;  // [texels, 3] of the unknown texels with a likeness, otherwise 0
  std::vector<float>
      likeness;  // [texels] at the best offset; 1: equal colours; 0: as of unrelated texels, or none known
};

/// The prediction of all unknown texels. The same for any number of threads.
Repeats find_repeats(const Exec& exec, const TextureGrid& grid);

}  // namespace ngs
