#pragma once
// Scalar maths of the multi-resolution hash encoding.                                     Eqs. (10)-(11)
#include <cmath>
#include <cstdint>
#include <type_traits>

#include "ngs/core/hd.h"
#include "ngs/math/stable.h"
#include "ngs/math/vec.h"
#include "ngs/scene/views.h"

namespace ngs {

inline constexpr int kMaxHashLevels = 16;

/// One resolution. `scale` cells span the box; the lookup is staggered by half a cell (D9).
struct HashLevel {
  float scale;               // Nmin · b^l - 1
  std::uint32_t resolution;  // vertices per axis, ceil(scale) + 1
  std::uint32_t size;        // table entries
  std::uint32_t offset;      // first entry in the table of all levels
  bool dense;                // resolution³ <= size: one entry per vertex; else hashed, size = 2^log2_table
};

/// World -> [0, 1]³ about the middle of the box; clamped. A degenerate axis (inv_extent = 0) maps to 0.5.
template <class T>
struct HashBox {
  Vec3<T> centre, inv_extent;
};

/// The 8 table entries around a point and the trilinear fractions. Corner bit 0: +x, bit 1: +y, bit 2: +z.
template <class T>
struct HashCell {
  std::uint32_t entry[8];
  T frac[3];
};

/// Eq. (10): XOR of coordinates times primes; the caller takes it modulo the table. The first factor is 1, so
/// neighbours in x share cache lines. Coordinates are integer vertices of the level, not world positions (C13).
NGS_HD inline std::uint32_t hash_vertex(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return x ^ (y * 2654435761u) ^ (z * 805459861u);
}

namespace detail {

/// Lower vertex and fraction of a point along one axis.
template <class T>
struct HashAxis {
  std::uint32_t lower;  // vertex
  T frac;

  NGS_HD HashAxis(T world, T centre, T inv_extent, T scale) {
    using std::floor;
    const T unit = T(0.5) + (world - centre) * inv_extent;
    const T at = clamp3(unit, T(0), T(1)) * scale + T(0.5);
    const T cell = floor(at);
    frac = at - cell;
    lower = std::uint32_t(double(cell));
  }
};

}  // namespace detail

/// Forced inline: called per level and query; measured a third cheaper than a call.
template <class T>
[[gnu::always_inline]] NGS_HD inline HashCell<T> hash_cell(const HashLevel& level, const HashBox<T>& box, Vec3<T> p) {
  const T scale = T(level.scale);
  const detail::HashAxis<T> x(p.x, box.centre.x, box.inv_extent.x, scale);
  const detail::HashAxis<T> y(p.y, box.centre.y, box.inv_extent.y, scale);
  const detail::HashAxis<T> z(p.z, box.centre.z, box.inv_extent.z, scale);
  HashCell<T> cell{{}, {x.frac, y.frac, z.frac}};
  for (std::uint32_t corner = 0; corner < 8; ++corner) {
    const std::uint32_t cx = x.lower + (corner & 1), cy = y.lower + (corner >> 1 & 1), cz = z.lower + (corner >> 2);
    std::uint32_t entry;
    if (level.dense) {
      // With the half-cell stagger the upper vertex may lie past the edge; the table then wraps, at most once.
      entry = cx + level.resolution * (cy + level.resolution * cz);
      if (entry >= level.size) entry -= level.size;
    } else {
      entry = hash_vertex(cx, cy, cz) & (level.size - 1);
    }
    cell.entry[corner] = level.offset + entry;
  }
  return cell;
}

/// Weight of a corner: Π over axes of frac or 1 - frac.
template <class T>
NGS_HD void corner_weights(const T* frac, T* weight) {
  const T x1 = frac[0], y1 = frac[1], z1 = frac[2], x0 = T(1) - x1, y0 = T(1) - y1, z0 = T(1) - z1;
  const T low0 = y0 * z0, low1 = y1 * z0, high0 = y0 * z1, high1 = y1 * z1;
  weight[0] = x0 * low0;
  weight[1] = x1 * low0;
  weight[2] = x0 * low1;
  weight[3] = x1 * low1;
  weight[4] = x0 * high0;
  weight[5] = x1 * high0;
  weight[6] = x0 * high1;
  weight[7] = x1 * high1;
}

/// Inputs of all kernels of the encoding. The output row of a query is level-major: [L][F].
template <class T>
struct HashGridView {
  const HashLevel* level;  // [L]
  int levels;
  HashBox<T> box;
  const T* table;          // [entries, F]
  Rows<const T, 3> point;  // [Q, 3] world
};

/// out[q, l, :] = Σ_corners weight · table[entry].                                            Eq. (11)
/// Index i = level · Q + q writes the F values of (q, level).
template <class T, int F>
struct HashForward {
  static constexpr const char* kName = "hash_forward";
  HashGridView<T> grid;
  T* out;  // [Q, L·F]

  NGS_HD void operator()(std::int64_t i) const { at(int(i / grid.point.n), i % grid.point.n); }
  NGS_HD void at(int l, std::int64_t q) const {
    const HashCell<T> cell = hash_cell(grid.level[l], grid.box, vec3(grid.point.row(q)));
    T weight[8], sum[F];
    corner_weights(cell.frac, weight);
    for (int f = 0; f < F; ++f) sum[f] = T(0);
    for (int corner = 0; corner < 8; ++corner)
      for (int f = 0; f < F; ++f)
        sum[f] += weight[corner] * grid.table[std::size_t(cell.entry[corner]) * F + std::size_t(f)];
    T* row = out + (q * grid.levels + l) * F;
    for (int f = 0; f < F; ++f) row[f] = sum[f];
  }
};

/// ∂L/∂table += Σ_q weight · ∂L/∂out.                                             adjoint of Eq. (11)
/// Index l writes the entries of level l and visits the queries in order: one writer, fixed order of summation.
template <class T, int F>
struct HashBackwardTable {
  static constexpr const char* kName = "hash_backward_table";
  HashGridView<T> grid;
  const T* grad_out;         // [Q, L·F]
  T* grad_table_accumulate;  // [entries, F]

  NGS_HD void operator()(std::int64_t l) const {
    for (std::int64_t q = 0; q < grid.point.n; ++q) at(l, q, [](T* to, T x) { *to += x; });
  }
  /// add(to, x) for every contribution of query q to level l.
  template <class Add>
  NGS_HD void at(std::int64_t l, std::int64_t q, const Add& add) const {
    const HashCell<T> cell = hash_cell(grid.level[l], grid.box, vec3(grid.point.row(q)));
    T weight[8];
    corner_weights(cell.frac, weight);
    const T* g = grad_out + (q * grid.levels + l) * F;
    for (int corner = 0; corner < 8; ++corner)
      for (int f = 0; f < F; ++f)
        add(grad_table_accumulate + (std::size_t(cell.entry[corner]) * F + std::size_t(f)), weight[corner] * g[f]);
  }
};

/// Calls body(std::integral_constant<int, F>) for the configured F, so that loops over features unroll.
template <class Body>
void with_hash_features(int features, const Body& body) {
  switch (features) {
    case 1: return body(std::integral_constant<int, 1>{});
    case 2: return body(std::integral_constant<int, 2>{});
    case 4: return body(std::integral_constant<int, 4>{});
    default: return body(std::integral_constant<int, 8>{});
  }
}

}  // namespace ngs
