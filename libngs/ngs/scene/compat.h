#pragma once
// The renderer whose constants apply where 3DGS (Inria) and gsplat differ: near_plane() and others of
// ops/splat/splat_options.h.                                                                        paper.md §5.1
#include <cstdint>

namespace ngs {

enum class Compat : std::uint8_t { kInria, kGsplat };

}  // namespace ngs
