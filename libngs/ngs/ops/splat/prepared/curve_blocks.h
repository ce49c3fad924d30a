#pragma once
// Parallel sort of points along a space-filling curve (Morton order). Internal to ops.      paper.md §5.1
#include <cstdint>
#include <span>

#include "ngs/backend/exec.h"
#include "ngs/core/raw_column.h"

namespace ngs {

/// Equals curve_order() of the points [N, 3], N < 2^32; uses all threads.
RawColumn<std::uint32_t> parallel_curve_order(const Exec& exec, std::span<const float> points);

}  // namespace ngs
