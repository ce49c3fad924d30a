#pragma once
// Projects a prepared cloud block by block: bit-identical to ViewProjector::project, in loops that the compiler
// vectorises. Internal to ops.                                                              Eq. (2); paper.md §5.1
#include "ngs/ops/splat/prepared/prepared_cloud.h"

namespace ngs {

/// Projects the Gaussians of `cloud` that may reach a pixel and are in columns.include (null: all) into memory.view, in
/// the order of `cloud`. A row with an empty rectangle reaches no pixel; its other members are undefined.
void project_blocks(const Exec& exec, const PreparedCloud& cloud, const CloudView<float>& columns,
                    const ViewProjector<float>& projector, ViewScratch<float>& memory);

}  // namespace ngs
