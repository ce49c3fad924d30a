#pragma once
// Runs the kernels of ops/optim/row_kernels.h. On a device their arrays must be resident (ops/optim/resident.h), but
// for GatherRows::part.
#include "ngs/backend/for_each.h"
#include "ngs/ops/device/device_ops.h"

namespace ngs {

/// Whether for_each_row() runs on a device.
inline bool rows_are_on_device(const Exec& exec) { return exec.device_ops != nullptr; }

template <class Kernel>
void for_each_row(const Exec& exec, std::int64_t rows, const Kernel& kernel) {
  if (exec.device_ops)
    exec.device_ops->arrays.run(kernel, rows);
  else
    for_each_index(exec, rows, kernel);
}

}  // namespace ngs
