#pragma once
// The hash encoding on a device. With DeviceSums::kInOrder, the contributions to the table's gradient are sorted by
// entry and summed per entry in the order of the CPU: the sums are equal to the CPU's. See Eqs. (10)-(11).
#include "ngs/backend/exec.h"
#include "ngs/backend/launcher.h"
#include "ngs/core/check.h"
#include "ngs/ops/field/hash_grid_kernels.h"

namespace ngs {

/// Contribution (level, query, corner); index i = level · Q + query.
struct HashContributions {
  static constexpr const char* kName = "hash_contributions";
  HashGridView<float> grid;
  std::uint64_t* key;    // [L·Q·8] out: table entry
  std::uint32_t* which;  // [L·Q·8] out: 0, 1, 2, ...
  float* weight;         // [L·Q·8] out

  NGS_HD void operator()(std::int64_t i) const {
    const std::uint32_t queries = std::uint32_t(grid.point.n), at = std::uint32_t(i);  // 8 L Q < 2^32
    const HashCell<float> cell = hash_cell(grid.level[at / queries], grid.box, vec3(grid.point.row(at % queries)));
    corner_weights(cell.frac, weight + i * 8);
    for (int corner = 0; corner < 8; ++corner) {
      key[i * 8 + corner] = cell.entry[corner];
      which[i * 8 + corner] = std::uint32_t(i * 8 + corner);
    }
  }
};

/// Index i is a contribution. The first one of an entry sums all of that entry, and owns the entry.
template <int F>
struct HashEntrySums {
  static constexpr const char* kName = "hash_entry_sums";
  const std::uint64_t* key;    // [n] sorted
  const std::uint32_t* which;  // [n]
  const float* weight;         // by `which`
  std::int64_t n;
  std::uint32_t queries;
  int levels;
  const float* grad_out;         // [Q, L·F]
  float* grad_table_accumulate;  // [entries, F]

  NGS_HD void operator()(std::int64_t i) const {
    if (i > 0 && key[i - 1] == key[i]) return;
    float* entry = grad_table_accumulate + std::int64_t(key[i]) * F;
    float sum[F];
    for (int f = 0; f < F; ++f) sum[f] = entry[f];
    for (std::int64_t k = i; k < n && key[k] == key[i]; ++k) {
      const std::uint32_t pair = which[k] / 8, query = pair % queries;
      const float* g = grad_out + (std::int64_t(query) * levels + pair / queries) * F;
      for (int f = 0; f < F; ++f) sum[f] += weight[which[k]] * g[f];
    }
    for (int f = 0; f < F; ++f) entry[f] = sum[f];
  }
};

/// Adds every contribution to its entry with atomic adds; index i = level · Q + query.
template <int F, class Launcher>
struct HashAtomicSums {
  static constexpr const char* kName = "hash_atomic_sums";
  HashBackwardTable<float, F> table;
  NGS_HD void operator()(std::int64_t i) const {
    const std::int64_t queries = table.grid.point.n;
    table.at(i / queries, i % queries, [](float* to, float x) { Launcher::atomic_add(to, x); });
  }
};

/// Adds to the kernel's table; its pointers are device pointers.
template <int F, class Launcher>
void hash_backward_on_device(Launcher& launcher, const HashBackwardTable<float, F>& kernel, std::uint64_t entries,
                             DeviceSums sums) {
  const HashGridView<float>& view = kernel.grid;
  const std::int64_t pairs = view.point.n * view.levels, n = pairs * 8;
  if (sums == DeviceSums::kAtomic) return launcher.parallel_for(pairs, HashAtomicSums<F, Launcher>{kernel});
  NGS_CHECK(n <= 0xffffffff, "contributions are counted in 32 bits");
  const DeviceBuffer<Launcher, std::uint64_t> key(launcher, n);
  const DeviceBuffer<Launcher, std::uint32_t> which(launcher, n);
  const DeviceBuffer<Launcher, float> weight(launcher, n);
  int bits = 1;
  while ((std::uint64_t(1) << bits) < entries) ++bits;
  launcher.parallel_for(pairs, HashContributions{view, key.data(), which.data(), weight.data()});
  launcher.sort(key.data(), which.data(), n, bits);
  launcher.parallel_for(n, HashEntrySums<F>{key.data(), which.data(), weight.data(), n, std::uint32_t(view.point.n),
                                            view.levels, kernel.grad_out, kernel.grad_table_accumulate});
}

}  // namespace ngs
