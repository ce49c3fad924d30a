#pragma once
// Neighbours in space as neighbours in memory, for models of any size. Internal to ops.      PAPER.md §5.1
#include <cstdint>
#include <span>

#include "ngs/backend/exec.h"
#include "ngs/core/raw_column.h"

namespace ngs {

/// As curve_order() of the points [N, 3], N < 2^32, by all threads.
RawColumn<std::uint32_t> parallel_curve_order(const Exec& exec, std::span<const float> points);

}  // namespace ngs
