#pragma once
// Predicts a texture from its repetition (He and Sun 2012). The offsets at which known texels are similar are found for
// the whole texture. An unknown texel becomes the weighted mean of the known texels at its best offsets. Tiles and
// stripes continue; other textures become smooth.
#include "ngs/backend/exec.h"
#include "ngs/edit/fill/texture_grid.h"

namespace ngs {

struct Repeats {
  std::vector<float> colour;  // [texels, 3] predicted colour of unknown texels; 0 without a prediction
  std::vector<float>
      likeness;  // [texels] at the best offset; 1: equal colours; 0: as of unrelated texels, or none known
};

/// The prediction of all unknown texels. The same for any number of threads.
Repeats find_repeats(const Exec& exec, const TextureGrid& grid);

}  // namespace ngs
