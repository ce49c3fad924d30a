#pragma once
// Colours of the hole in a texture: its repetition (texture_repeats.h); copies of known patches where it has detail that
// does not repeat (Criminisi et al. 2004: the cell whose surroundings are known best and at the strongest edge first); a
// smooth blend where it has none.
#include <cstdint>
#include <vector>

#include "ngs/backend/exec.h"

namespace ngs {

enum class Texel : std::uint8_t { kNone, kKnown, kUnknown };  // kNone: no part of the texture, never read

struct TextureGrid {
  std::int64_t columns = 0, rows = 0;
  std::vector<Texel> state;   // [rows · columns]
  std::vector<float> colour;  // [rows · columns, 3] any finite values where known
};

enum class TextureFill : std::uint8_t { kNothing, kSmooth, kPatches, kRepeats };

/// Sets the colour of all unknown texels, and their state to kKnown. kNothing: no texel is known, or none unknown.
/// Patches are taken whole from known texels; without a whole known patch, the blend is used. `detail` >= 0: the blend is
/// used unless the known texels differ by more than this from the mean of two on opposite sides (RMS, all channels).
/// The same bytes for any number of threads.
TextureFill fill_texture(const Exec& exec, TextureGrid& grid, double detail);

/// The blend alone: every unknown texel is the mean of its four neighbours (Laplace's equation).
void fill_smoothly(TextureGrid& grid);

}  // namespace ngs
