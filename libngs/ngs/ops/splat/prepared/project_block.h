#pragma once
// Projection of a prepared cloud in blocks of rows: ViewProjector::project, bit for bit, in loops that the compiler
// makes ones of packs. Internal to ops.                                                     Eq. (2); PAPER.md §5.1
#include "ngs/ops/splat/prepared/prepared_cloud.h"

namespace ngs {

/// Projects the Gaussians of `cloud` that may reach a pixel and are in `include` [N] (null: all) into memory.view, in
/// the order of `cloud`. A row with an empty rectangle reaches none after all, and its other members mean nothing.
void project_blocks(const Exec& exec, const PreparedCloud& cloud, const CloudView<float>& columns,
                    const ViewProjector<float>& projector, PassMemory<float>& memory);

}  // namespace ngs
